//! A value that threads use in the order in which they ask for it.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::run::SIGNALS;

/// A value that one thread uses at a time. A long call takes a turn for each of its parts, so that other threads come in
/// between.
pub(crate) struct InTurn<T> {
    value: Mutex<T>,
    /// The thread that uses the value, then those that wait.
    threads: Mutex<VecDeque<ThreadId>>,
    changed: Condvar,
    /// What is told to a function that asks for the value while its own thread has it or waits for it.
    busy: &'static str,
}

/// The turn of this thread, or its place among those that wait.
struct Turn<'a> {
    threads: &'a Mutex<VecDeque<ThreadId>>,
    changed: &'a Condvar,
}

impl Drop for Turn<'_> {
    fn drop(&mut self) {
        let me = thread::current().id();
        lock(self.threads).retain(|thread| *thread != me);
        self.changed.notify_all();
    }
}

/// The value behind a lock, also after a panic.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<T> InTurn<T> {
    pub(crate) fn new(value: T, busy: &'static str) -> Self {
        let (value, threads, changed) = (Mutex::new(value), Mutex::default(), Condvar::new());
        InTurn { value, threads, changed, busy }
    }

    /// Does something with the value when it is the turn of this thread. It waits without the interpreter, which the thread
    /// before it may need, and hears signals. RuntimeError in a function that the value calls: it would wait for itself.
    pub(crate) fn with<R>(&self, py: Python<'_>, act: impl FnOnce(&mut T) -> R) -> PyResult<R> {
        let InTurn { threads, changed, busy, .. } = self;
        let me = thread::current().id();
        let mut queue = lock(threads);
        if queue.contains(&me) {
            return Err(PyRuntimeError::new_err(*busy));
        }
        queue.push_back(me);
        drop(queue);
        let _turn = Turn { threads, changed };
        let waits = |queue: &mut VecDeque<ThreadId>| queue.front() != Some(&me);
        while waits(&mut lock(threads)) {
            py.detach(|| drop(changed.wait_timeout_while(lock(threads), SIGNALS, waits)));
            py.check_signals()?;
        }
        Ok(act(&mut lock(&self.value)))
    }
}
