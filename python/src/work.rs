//! Long work without Python's lock.
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::Duration;

/// How often Ctrl-C and events are looked for.
const TICK: Duration = Duration::from_millis(50);

/// Does some work in a thread of its own, while this one waits without Python's lock, and now and then looks for Ctrl-C and
/// hands events (JSON texts) to an observer. Where either raises an exception, `stop` becomes true, the work is waited for,
/// and the exception is returned.
pub fn work<T: Send>(
    py: Python<'_>,
    stop: &AtomicBool,
    events: Option<(&Receiver<String>, &Py<PyAny>)>,
    job: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    let mut raised = None;
    let mut look = || {
        let told = events.map_or(Ok(()), |(events, observer)| {
            (events.try_iter()).try_for_each(|text| observer.call1(py, (text,)).map(drop))
        });
        if let Err(error) = told.and_then(|()| py.check_signals())
            && raised.is_none()
        {
            stop.store(true, Ordering::Relaxed);
            raised = Some(error);
        }
    };
    let outcome = thread::scope(|scope| {
        let (done, mut answer) = mpsc::channel();
        scope.spawn(move || {
            // Its receiver is waited with until it has come.
            let _ = done.send(job());
        });
        loop {
            let waited;
            (answer, waited) = py.detach(move || {
                let waited = answer.recv_timeout(TICK);
                (answer, waited)
            });
            match waited {
                Ok(answer) => return Some(answer),
                Err(RecvTimeoutError::Timeout) => look(),
                Err(RecvTimeoutError::Disconnected) => return None,
            }
        }
    });
    look();
    if let Some(error) = raised {
        stop.store(false, Ordering::Relaxed);
        return Err(error);
    }
    outcome.ok_or_else(|| PyRuntimeError::new_err("internal error: the computation broke off"))
}
