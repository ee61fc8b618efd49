//! No thread changes a value while another one keeps it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use babble_env::guarded::{Guarded, Refusal};

#[test]
fn the_keepers_thread_enters_again_and_others_are_refused_until_it_has_left_as_often() {
    let value = Guarded::new(1);
    value.enter().unwrap();
    value.enter().unwrap();
    value.leave();
    *value.write().unwrap() += 1;
    assert_eq!(*value.read().unwrap(), 2);
    thread::scope(|scope| {
        scope.spawn(|| {
            assert_eq!(value.enter(), Err(Refusal::Busy));
            assert!(value.read().is_err());
            assert!(value.write().is_err());
        });
    });
    value.leave();
    thread::scope(|scope| {
        scope.spawn(|| *value.write().unwrap() += 1);
    });
    assert_eq!(*value.read().unwrap(), 3);
}

#[test]
fn a_value_in_use_cannot_be_kept() {
    let value = Guarded::new(1);
    let reading = value.read().unwrap();
    thread::scope(|scope| {
        scope.spawn(|| {
            assert_eq!(value.enter(), Err(Refusal::Busy));
            assert!(value.read().is_ok());
        });
    });
    drop(reading);
    value.enter().unwrap();
    value.leave();
}

#[test]
fn a_value_that_a_panic_left_half_changed_is_not_used_again() {
    let value = Guarded::new(1);
    let panicked = catch_unwind(AssertUnwindSafe(|| {
        let _writing = value.write().unwrap();
        panic!("on purpose");
    }));
    assert!(panicked.is_err());
    assert_eq!(value.read().err(), Some(Refusal::Poisoned));
    assert_eq!(value.write().err(), Some(Refusal::Poisoned));
}

/// Looking for the keeper before the lock is taken would let a write in between.
#[test]
fn no_write_of_another_thread_falls_between_two_reads_of_the_keeper() {
    const ENOUGH: u32 = 200_000;
    let (value, stop) = (Guarded::new(0_u64), AtomicBool::new(false));
    let stranger = || {
        while !stop.load(Ordering::Relaxed) {
            if let Ok(mut value) = value.write() {
                *value += 1;
            }
        }
    };
    let keeper = || {
        let (mut kept, deadline) = (0, Instant::now() + Duration::from_secs(5));
        while kept < ENOUGH && Instant::now() < deadline {
            if value.enter().is_ok() {
                let first = *value.read().unwrap();
                (0..20).for_each(|_| std::hint::spin_loop());
                assert_eq!(*value.read().unwrap(), first, "after {kept} times");
                value.leave();
                kept += 1;
            }
        }
        kept
    };
    let kept = thread::scope(|scope| {
        scope.spawn(stranger);
        let kept = scope.spawn(keeper).join();
        stop.store(true, Ordering::Relaxed);
        kept
    });
    assert!(kept.unwrap() > 1_000);
    assert!(*value.read().unwrap() > 1_000);
}
