//! What interrupts a pool and a batch, and what state it leaves them in.

use std::cell::Cell;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
use std::sync::{Arc, LazyLock};
use std::thread::{self, ThreadId};
use std::time::{Duration, Instant};

use babble_env::picture::View;
use babble_env::progress::{Ending, Lifecycle, Phase, Progress};
use babble_env::spec::{Entry, Spec};
use babble_env::task::{MAX_TERMS, Task};
use babble_env::{
    Autoreset, Batch, Config, EnvError, Executor, Outcome, ReachOptions, ReachTask, Stop, Stream,
};
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
    /// Limited episodes that can still be drawn.
    draws: AtomicU32,
}

impl Slow {
    fn new(making: Duration) -> Arc<Self> {
        let draws = AtomicU32::new(1);
        Arc::new(Self { making, draws })
    }
}

/// How far it has counted. A request says whether its draws are limited.
#[derive(Clone, Debug, PartialEq, Serialize, serde::Deserialize)]
struct Count {
    sum: f32,
    progress: Progress,
    lifecycle: Lifecycle<bool>,
}

impl Task for Slow {
    type Request = bool;
    type Drawn = ();
    type State = Count;
    type Derived = ();
    type Potential = ();
    const NAME: &'static str = "slow";
    const MAGIC: [u8; 4] = *b"SLOW";
    const OUTCOMES: &'static [Outcome] = &[Outcome::Running, Outcome::Success];

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
        let entry = |name, labels| Entry {
            name,
            labels,
            low: vec![],
            high: vec![],
            unit: "1".into(),
            description: "",
        };
        let goals = ["achieved_goal", "desired_goal"].map(|name| entry(name, vec!["sum"]));
        Spec {
            senses: vec![],
            goals: goals.into(),
            action: entry("action", vec![]),
            reward_terms: &[],
            reward_bounds: [0.0, 1.0],
            facts: &[],
            measures: &[],
            outcomes: vec![],
            max_episode_steps: 3,
            control_hz: 1.0,
        }
    }

    fn fingerprint(&self) -> impl Serialize {
        Self::NAME
    }

    fn shared(state: &Count) -> (&Progress, &Lifecycle<bool>) {
        (&state.progress, &state.lifecycle)
    }

    fn shared_mut(state: &mut Count) -> (&mut Progress, &mut Lifecycle<bool>) {
        (&mut state.progress, &mut state.lifecycle)
    }

    fn fresh(&self, lifecycle: Lifecycle<bool>) -> Count {
        thread::sleep(self.making);
        Count {
            sum: 0.0,
            progress: Progress::START,
            lifecycle,
        }
    }

    fn check(&self, _: &mut Count) -> Result<(), EnvError> {
        Ok(())
    }

    fn derive(&self, _: &Count) {}

    fn draw(&self, limited: &bool, _: &mut Stream, _: &Stop<'_>) -> Result<(), EnvError> {
        let take = |left: u32| left.checked_sub(1);
        if *limited && self.draws.fetch_update(Relaxed, Relaxed, take).is_err() {
            return Err(EnvError::NoLegalCase {
                drawn: 1,
                played: 1,
            });
        }
        Ok(())
    }

    fn begin(&self, state: &mut Count, (): ()) {
        thread::sleep(STEP);
        state.sum = 0.0;
    }

    fn ending(&self) -> Ending {
        Ending {
            goal: false,
            goes_on: false,
            single_step: false,
            max_steps: 1_000,
        }
    }

    fn potential(&self, _: &Count) {}

    fn advance(&self, state: &mut Count, (): &mut (), action: &[f32]) -> Result<bool, EnvError> {
        thread::sleep(STEP);
        state.sum += action[0];
        Ok(state.sum >= 3.0)
    }

    fn reward_terms(&self, _: &Count, (): ()) -> [f64; MAX_TERMS] {
        [0.0; MAX_TERMS]
    }

    fn observe(&self, state: &Count, (): &(), out: &mut [f32]) {
        out[0] = state.sum;
    }

    fn goals(&self, state: &Count, achieved: &mut [f32], desired: &mut [f32]) {
        achieved.copy_from_slice(&[state.sum]);
        desired.copy_from_slice(&[3.0]);
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

/// n environments that were reset.
fn slow(n: usize, pool: Executor, autoreset: Autoreset) -> Batch<Slow> {
    let task = Slow::new(Duration::ZERO);
    let mut batch = Batch::with_executor(task, n, autoreset, pool).unwrap();
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
        // A pool of threads asks before it begins too, where the last time was long ago.
        ASKED.set((0, 1));
        assert_eq!(batch.step(&[1.0; N]), Err(EnvError::Interrupted));
        let stepped: f32 = (0..N).map(|i| batch.state(i).unwrap().sum).sum();
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
        assert!((0..N).all(|i| batch.state(i).unwrap().sum == 1.0));
    }
}

/// Environments of an arm so thick that no movement is legal, each of which takes long to try.
fn hopeless(n: usize, executor: Executor) -> Batch<ReachTask> {
    let config = Config::from_json(
        r#"{"body": {"arm": {"half_width_m": 0.05}, "obstacle": {"radius_m": 0.05}},
            "reach": {"control_period_s": 0.001, "movement_s": 7.999}}"#,
    );
    let task = ReachTask::new(config.unwrap(), ReachOptions::default()).unwrap();
    Batch::with_executor(Arc::new(task), n, Autoreset::NextStep, executor).unwrap()
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
            assert_eq!(state.lifecycle.phase, expected, "{i}");
        }
        assert_eq!(batch.state(3).unwrap().sum, 1.0);
        ASKED.set((0, u32::MAX));
        batch.reset(&mask).unwrap();
        batch.step(&[1.0; N]).unwrap();
    }
}

/// A search that takes a second is interrupted in its middle, of one environment too, and needs another
/// reset. Catches a draw that nobody asks.
#[test]
fn an_interrupted_draw_ends_in_its_middle() {
    for (n, threads) in [(1, 1), (3, 1), (3, 2)] {
        let mut calm = hopeless(n, Executor::new(threads).unwrap());
        let searched = calm.reset(&vec![true; n]);
        assert!(matches!(searched, Err(EnvError::NoLegalCase { .. })));
        // Without the question in its middle the search would end with the same error.
        let mut hasty = hopeless(n, after(0, threads));
        assert_eq!(hasty.reset(&vec![true; n]), Err(EnvError::Interrupted));
    }
}

/// Where no case can be drawn for one ended episode, the others were stepped and what they showed is
/// lost: the batch is left as by an interruption, with either autoreset and any number of threads.
/// Catches a batch that steps on as if the failed step had never been.
#[test]
fn a_failed_automatic_reset_leaves_environments_that_need_a_reset() {
    let unplayable = Err(EnvError::NoLegalCase {
        drawn: 1,
        played: 1,
    });
    let needs_reset = Err(EnvError::NeedsReset { env: 0 });
    for threads in [1, 2] {
        for autoreset in [Autoreset::SameStep, Autoreset::NextStep] {
            let mut batch = slow(8, Executor::new(threads).unwrap(), autoreset);
            batch.request(5, true).unwrap();
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
            batch.task().draws.store(2, Relaxed);
            batch.reset(&[true; 8]).unwrap();
            batch.step(&actions).unwrap();
        }
    }
}

/// Goals of this task are one number each. Catches records that think of positions in the plane.
#[test]
fn goals_are_as_long_as_the_spec_says() {
    let mut batch = slow(2, Executor::new(1).unwrap(), Autoreset::Disabled);
    batch.step(&[0.5, 1.0]).unwrap();
    let shown: Vec<_> = batch
        .records()
        .map(|r| (&r.achieved[..], &r.desired[..]))
        .collect();
    let goal: &[f32] = &[3.0];
    assert_eq!(shown, [(&[0.5][..], goal), (&[1.0], goal)]);
}

/// Making a batch can be interrupted too. Catches the one long loop that nobody thinks of.
#[test]
fn making_a_batch_can_be_interrupted() {
    let task = Slow::new(STEP);
    let made = Batch::with_executor(task, N, Autoreset::NextStep, after(0, 1));
    assert_eq!(made.err(), Some(EnvError::Interrupted));
}

/// It is the waiting thread that is asked, every 50 ms: not for work that is shorter, not by every
/// item, and not from the pool's threads, where no signal is handled.
#[test]
fn the_thread_that_waits_is_asked_now_and_then() {
    let mut items = [(); N];
    let sleeping = |_: usize, (): &mut (), _: &Stop<'_>| {
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
        let result = pool.for_each(&mut done, 1, |i, item, _| {
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
