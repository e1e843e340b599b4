//! Long calls that Ctrl-C or a time limit ends.

use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use palpate::recognize::Halt;
use pyo3::prelude::*;

use crate::options::Deadline;

/// How often signals are looked for.
const PAUSE: Duration = Duration::from_millis(50);

/// Runs `work` without the interpreter's lock, on another thread, while this one looks for signals. When one raises, `work`
/// is told to halt, and what it raised is raised.
pub(crate) fn interruptible<T: Send>(py: Python<'_>, work: impl FnOnce(&Halt) -> T + Send) -> PyResult<T> {
    interruptible_until(py, Deadline::NEVER, work)
}

/// The same, and `work` is told to halt at the deadline too; what it has by then is its answer.
pub(crate) fn interruptible_until<T: Send>(
    py: Python<'_>,
    deadline: Deadline,
    work: impl FnOnce(&Halt) -> T + Send,
) -> PyResult<T> {
    let halt = Halt::default();
    let flag = Halt::clone(&halt);
    let outcome = py.detach(move || {
        rayon::in_place_scope(|scope| {
            let (done, result) = channel();
            let told = Halt::clone(&flag);
            scope.spawn(move |_| drop(done.send(work(&told))));
            let mut raised = None;
            loop {
                match result.recv_timeout(deadline.left(PAUSE)) {
                    Ok(value) => return raised.map_or(Some(Ok(value)), |error| Some(Err(error))),
                    Err(RecvTimeoutError::Timeout) if raised.is_none() => {
                        let signals = Python::attach(|py: Python<'_>| -> PyResult<()> { py.check_signals() });
                        raised = signals.err();
                        flag.store(raised.is_some() || deadline.passed(), Relaxed);
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                    // The work panicked: the scope will say so.
                    Err(RecvTimeoutError::Disconnected) => return None,
                }
            }
        })
    });
    outcome.expect("the scope passes on a panic of the work")
}
