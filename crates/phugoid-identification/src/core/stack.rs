//! Runs work that needs more stack than a common thread has.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError, mpsc};
use std::thread;

/// Stack of a thread that estimates, bytes: an estimator with room for 48 columns takes 3.1 MB in all its copies while
/// it is set up (measured), a common thread has 2 MB. Only what is touched becomes memory.
pub const STACK_BYTES: usize = 16 << 20;

/// Runs `work` on a thread of its own with [`STACK_BYTES`] of stack, and waits; `progress` is called from the caller's
/// thread, in order.
pub(crate) fn on_a_large_stack<T: Send, W>(work: &W, progress: &mut dyn FnMut(f64)) -> T
where
    W: Fn(&mut dyn FnMut(f64)) -> T + Sync,
{
    thread::scope(|scope| {
        let (sender, receiver) = mpsc::channel();
        let worker = thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, move || {
            work(&mut |done| {
                // The receiver lives until the work is done.
                let _ = sender.send(done);
            })
        });
        match worker {
            Ok(worker) => {
                receiver.iter().for_each(&mut *progress);
                worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
            }
            // Where the system gives no further thread, the caller's own has to do.
            Err(_) => work(progress),
        }
    })
}

/// Does the jobs `0..jobs` on as many threads as there are cores, each with [`STACK_BYTES`] of stack, and gives their results in
/// order; the caller, whose stack has to be as large, works with them.
pub(crate) fn on_large_stacks<T: Send>(jobs: usize, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let results: Mutex<Vec<Option<T>>> = Mutex::new((0..jobs).map(|_| None).collect());
    let take_turns = || {
        loop {
            let job = next.fetch_add(1, Ordering::Relaxed);
            if job >= jobs {
                return;
            }
            let result = work(job);
            let mut results = results.lock().unwrap_or_else(PoisonError::into_inner);
            results[job] = Some(result);
        }
    };
    let cores = thread::available_parallelism().map_or(1, usize::from).min(jobs);
    thread::scope(|scope| {
        for _ in 1..cores {
            // Where the system gives no further thread, those that there are do the work.
            let _ = thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, take_turns);
        }
        take_turns();
    });
    results.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().flatten().collect()
}
