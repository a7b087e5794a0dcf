//! Work that needs more stack than some threads have.

use std::thread;

use phugoid_identification::stack::STACK_BYTES;

/// Does `work` on a thread with stack enough where it is `large`, else here.
pub(crate) fn with_stack<T: Send>(large: bool, work: impl FnOnce() -> T + Send) -> T {
    if !large {
        return work();
    }
    let mut work = Some(work);
    let done = thread::scope(|scope| {
        let work = &mut work;
        let worker =
            thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(scope, move || work.take().map(|w| w()));
        worker.ok().map(|worker| worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    });
    match (done.flatten(), work) {
        (Some(result), _) => result,
        // A system that gives no further thread: this one does it.
        (None, Some(work)) => work(),
        (None, None) => unreachable!("the work is either done or still here"),
    }
}
