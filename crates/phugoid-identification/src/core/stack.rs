//! Runs work that needs more stack than a common thread has.

use std::sync::mpsc;
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
