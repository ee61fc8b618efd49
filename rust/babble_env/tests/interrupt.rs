//! What interrupts a pool and a batch, and what state it leaves them in.

use std::cell::Cell;
use std::sync::{Arc, LazyLock};
use std::thread::{self, ThreadId};
use std::time::{Duration, Instant};

use babble_env::picture::View;
use babble_env::spec::{Entry, Spec};
use babble_env::task::{Episode, EpisodeInfo, Phase, Step, Task};
use babble_env::{Autoreset, Batch, Config, EnvError, Executor, Outcome, Stream};
use image::RgbImage;
use serde::Serialize;

/// Environments whose steps take a millisecond each: longer than a pool waits until it asks, also in
/// two threads.
const N: usize = 160;
const STEP: Duration = Duration::from_millis(1);

thread_local! {
    /// How often this thread is asked before the answer is yes, and how often it was.
    static ASKED: Cell<(u32, u32)> = const { Cell::new((0, 0)) };
}

/// Nobody interrupts for as many times as [`after`] says.
fn interrupted() -> bool {
    let (asked, most) = ASKED.get();
    ASKED.set((asked + 1, most));
    asked >= most
}

/// A pool that is interrupted when it asks for the (`most` + 1)-th time.
fn after(most: u32, threads: usize) -> Executor {
    ASKED.set((0, most));
    Executor::new(threads).unwrap().interrupted_by(interrupted)
}

/// A task that takes its time, also to make an environment: an action counts up, to the end of an
/// episode at 3.
#[derive(Debug)]
struct Slow {
    making: Duration,
}

/// How far it has counted, how it stands, and episodes that can still be drawn.
#[derive(Clone, Debug, PartialEq, Serialize, serde::Deserialize)]
struct Count(f32, Phase, u32);

impl Task for Slow {
    type Episode = Count;
    const NAME: &'static str = "slow";
    const MAGIC: [u8; 4] = *b"SLOW";

    fn config(&self) -> &Config {
        static PAPER: LazyLock<Config> = LazyLock::new(|| Config::profile("paper").unwrap());
        &PAPER
    }

    fn min_per_thread(&self) -> usize {
        1
    }

    fn action_len(&self) -> usize {
        1
    }

    fn senses_len(&self) -> usize {
        1
    }

    fn spec(&self) -> Spec {
        let action = Entry {
            name: "action",
            labels: vec![],
            low: vec![],
            high: vec![],
            unit: "1".into(),
            description: "",
        };
        Spec {
            senses: vec![],
            goals: vec![],
            action,
            reward_terms: &[],
            facts: &[],
            outcomes: vec![],
            max_episode_steps: 3,
            control_hz: 1.0,
        }
    }

    fn fingerprint(&self) -> impl Serialize {
        Self::NAME
    }

    fn moments(&self, _: &Count) -> usize {
        0
    }

    fn picture(
        &self,
        _: &Count,
        _: View,
        [width, height]: [u32; 2],
        _: Option<usize>,
    ) -> Result<RgbImage, EnvError> {
        Ok(RgbImage::new(width, height))
    }
}

impl Episode for Count {
    type Task = Slow;
    type Request = u32;
    type NextEpisode = ();
    type State = Self;

    fn new(task: &Slow, _: Stream) -> Self {
        thread::sleep(task.making);
        Self(0.0, Phase::Fresh, 1_000)
    }

    fn check(_: &Slow, _: &mut Self) -> Result<(), EnvError> {
        Ok(())
    }

    fn from_state(_: &Slow, state: Self) -> Self {
        state
    }

    fn state(&self) -> &Self {
        self
    }

    fn phase(&self) -> Phase {
        self.1
    }

    fn seed(&mut self, _: Stream) {}

    fn request(&mut self, draws: u32) {
        self.2 = draws;
    }

    fn draw(&mut self, _: &Slow) -> Result<(), EnvError> {
        if self.2 == 0 {
            return Err(EnvError::NoLegalCase { tries: 1 });
        }
        Ok(())
    }

    fn begin(&mut self, _: &Slow, (): ()) {
        thread::sleep(STEP);
        *self = Self(0.0, Phase::Running, self.2 - 1);
    }

    fn abandon(&mut self) {
        self.1 = Phase::Fresh;
    }

    fn step(&mut self, _: &Slow, action: &[f32]) -> Result<Step, EnvError> {
        thread::sleep(STEP);
        self.0 += action[0];
        let terminated = self.0 >= 3.0;
        if terminated {
            self.1 = Phase::Ended;
        }
        Ok(Step {
            terminated,
            ..Step::default()
        })
    }

    fn observe(&self, _: &Slow, out: &mut [f32]) {
        out[0] = self.0;
    }

    fn info(&self, _: &Slow) -> EpisodeInfo {
        EpisodeInfo {
            achieved: [0.0; 2],
            desired: [0.0; 2],
            outcome: Outcome::Running,
            facts: [false; _],
        }
    }
}

/// n environments that were reset.
fn slow(n: usize, pool: Executor, autoreset: Autoreset) -> Batch<Slow> {
    let making = Duration::ZERO;
    let mut batch = Batch::with_executor(Arc::new(Slow { making }), n, autoreset, pool).unwrap();
    batch.reset(&vec![true; n]).unwrap();
    batch
}

/// An interrupted step has stepped some environments and not others, and all of them, and their
/// copies, refuse to step on until they are reset; then the batch is as good as new. Catches an
/// interruption that is seen after the last environment alone, and a batch that goes on with
/// environments of different ages.
#[test]
fn an_interrupted_step_leaves_environments_that_need_a_reset() {
    for threads in [1, 2] {
        let mut batch = slow(N, after(u32::MAX, threads), Autoreset::NextStep);
        ASKED.set((0, 0));
        assert_eq!(batch.step(&[1.0; N]), Err(EnvError::Interrupted));
        let stepped: f32 = (0..N).map(|i| batch.state(i).unwrap().0).sum();
        println!("{threads} threads: {stepped} of {N} stepped");
        assert!((1.0..N as f32).contains(&stepped), "{stepped}");
        assert_eq!(batch.step(&[1.0; N]), Err(EnvError::NeedsReset { env: 0 }));
        for i in [0, N - 1] {
            let mut copy = slow(1, after(u32::MAX, 1), Autoreset::NextStep);
            copy.load(0, &batch.save(i).unwrap()).unwrap();
            assert_eq!(copy.step(&[1.0]), Err(EnvError::NeedsReset { env: 0 }));
        }
        let mut mask = [true; N];
        mask[7] = false;
        batch.reset(&mask).unwrap();
        assert_eq!(batch.step(&[1.0; N]), Err(EnvError::NeedsReset { env: 7 }));
        batch.reset(&mask.map(|chosen| !chosen)).unwrap();
        batch.step(&[1.0; N]).unwrap();
        assert!((0..N).all(|i| batch.state(i).unwrap().0 == 1.0));
    }
}

/// After an interrupted reset those that it chose need another; the others step on. Catches episodes
/// that go on beside half of a new batch.
#[test]
fn an_interrupted_reset_leaves_the_others_alone() {
    for threads in [1, 2] {
        let mut batch = slow(N, after(u32::MAX, threads), Autoreset::NextStep);
        batch.step(&[1.0; N]).unwrap();
        ASKED.set((0, 0));
        let mut mask = [true; N];
        mask[3] = false;
        assert_eq!(batch.reset(&mask), Err(EnvError::Interrupted));
        for i in 0..N {
            let state = batch.state(i).unwrap();
            let expected = if i == 3 { Phase::Running } else { Phase::Fresh };
            assert_eq!(state.1, expected, "{i}");
        }
        assert_eq!(batch.state(3).unwrap().0, 1.0);
        ASKED.set((0, u32::MAX));
        batch.reset(&mask).unwrap();
        batch.step(&[1.0; N]).unwrap();
    }
}

/// Where no case can be drawn for one ended episode, the others were stepped and what they showed is
/// lost: the batch is left as by an interruption, with either autoreset and any number of threads.
/// Catches a batch that steps on as if the failed step had never been.
#[test]
fn a_failed_automatic_reset_leaves_environments_that_need_a_reset() {
    let unplayable = Err(EnvError::NoLegalCase { tries: 1 });
    let needs_reset = Err(EnvError::NeedsReset { env: 0 });
    for threads in [1, 2] {
        for autoreset in [Autoreset::SameStep, Autoreset::NextStep] {
            let mut batch = slow(8, Executor::new(threads).unwrap(), autoreset);
            batch.request(5, 1).unwrap();
            batch.reset(&[true; 8]).unwrap();
            let mut actions = [1.0; 8];
            actions[5] = 3.0;
            if autoreset == Autoreset::NextStep {
                batch.step(&actions).unwrap();
            }
            assert_eq!(batch.step(&actions), unplayable);
            assert_eq!(batch.step(&actions), needs_reset);
            // A reset that fails in the same way changes nothing.
            assert_eq!(batch.reset(&[true; 8]), unplayable);
            assert_eq!(batch.step(&actions), needs_reset);
            batch.request(5, 2).unwrap();
            batch.reset(&[true; 8]).unwrap();
            batch.step(&actions).unwrap();
        }
    }
}

/// Making a batch can be interrupted too. Catches the one long loop that nobody thinks of.
#[test]
fn making_a_batch_can_be_interrupted() {
    let task = Arc::new(Slow { making: STEP });
    let made = Batch::with_executor(task, N, Autoreset::NextStep, after(0, 1));
    assert_eq!(made.err(), Some(EnvError::Interrupted));
}

/// It is the waiting thread that is asked, every 50 ms: not for work that is shorter, not by every
/// item, and not from the pool's threads, where no signal is handled.
#[test]
fn the_thread_that_waits_is_asked_now_and_then() {
    let mut items = [(); N];
    let sleeping = |_: usize, (): &mut ()| {
        thread::sleep(STEP);
        Ok(())
    };
    for threads in [1, 2] {
        let mut pool = after(u32::MAX, threads);
        let began = Instant::now();
        pool.for_each(&mut items, 1, sleeping).unwrap();
        let most = (began.elapsed().as_secs_f64() / 0.05) as u32;
        let (asked, _) = ASKED.get();
        assert!((1..=most).contains(&asked), "{asked} of {most}");
        pool.for_each(&mut items[..8], 1, sleeping).unwrap();
    }
}

/// Work in other threads than the caller's, to its end if nothing interrupts it; and its errors in
/// the order of the items, whichever comes first in time, after all items were done.
#[test]
fn the_first_error_in_order_is_told_after_all_are_done() {
    for threads in [1, 2, 8] {
        let mut pool = after(u32::MAX, threads);
        let mut done: Vec<Option<ThreadId>> = vec![None; 64];
        let result = pool.for_each(&mut done, 1, |i, item| {
            thread::sleep(Duration::from_micros(if i == 20 { 3_000 } else { 100 }));
            *item = Some(thread::current().id());
            if i >= 20 {
                return Err(EnvError::NeedsReset { env: i });
            }
            Ok(())
        });
        assert_eq!(result, Err(EnvError::NeedsReset { env: 20 }));
        let here = thread::current().id();
        assert!(done.iter().all(Option::is_some));
        assert!(done.iter().all(|id| (*id == Some(here)) == (threads == 1)));
    }
}

/// A panic in a thread of the pool is the caller's, and the pool works on. Catches a caller that
/// waits for an answer that never comes.
#[test]
fn a_panic_comes_through() {
    let mut pool = after(u32::MAX, 2);
    let panics = std::panic::AssertUnwindSafe(|| pool.run_until(|_| panic!("on purpose")));
    assert!(std::panic::catch_unwind(panics).is_err());
    assert_eq!(pool.run_until(|_| 7), Ok(7));
}

/// Work that is done before it notices the interruption is interrupted all the same: the exception
/// of the signal's handler must not be lost.
#[test]
fn an_interruption_is_never_lost() {
    let late = after(0, 2).run_until(|_| thread::sleep(Duration::from_millis(120)));
    assert_eq!(late, Err(EnvError::Interrupted));
}
