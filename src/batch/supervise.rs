//! The run's side of one worker: started, listened to, ended when its time is over.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::interrupt::Interrupt;
use super::system;
use super::task::{Order, Word};
use crate::job::failure::{PartError, code};
use crate::job::run::Stage;

/// Word on the command line that makes a process a worker.
pub const WORKER: &str = "worker";

/// How often a waiting run looks whether it was interrupted.
const LOOK: Duration = Duration::from_millis(50);

/// Time that a worker may take to end after it closed its output.
const SETTLING: Duration = Duration::from_secs(5);

/// Bytes kept of a worker's last words.
const KEPT: usize = 4096;

/// What the allocator says before it ends the process.
const NO_MEMORY: &str = "memory allocation of";

/// Has a worker do a task. `hear` is told what it does.
///
/// # Errors
/// [`PartError`] of a worker that gave no answer: out of time or memory, crashed, not started, interrupted.
pub(super) fn supervise(
    order: &Order,
    time: Duration,
    interrupt: &Interrupt,
    hear: &mut dyn FnMut(&Stage),
) -> Result<Word, PartError> {
    let scratch = tempfile::Builder::new().prefix("resurf-").tempdir().map_err(PartError::NotStarted)?;
    let mut worker = Worker::start(order, scratch.path()).map_err(PartError::NotStarted)?;
    let deadline = Instant::now() + time;
    let mut stage = None;
    let answer = loop {
        match worker.words.recv_timeout(LOOK) {
            Ok(Ok(Word::Stage(next))) => {
                hear(&next);
                stage = Some(next);
            }
            Ok(Ok(answer)) => break Some(answer),
            Ok(Err(error)) => {
                worker.end();
                return Err(PartError::Crash { stage, words: format!("the answer cannot be read: {error}") });
            }
            Err(RecvTimeoutError::Disconnected) => break None,
            Err(RecvTimeoutError::Timeout) => {}
        }
        if interrupt.asked() {
            worker.end();
            return Err(PartError::Interrupted);
        }
        if Instant::now() >= deadline {
            worker.end();
            return Err(PartError::OutOfTime { seconds: time.as_secs_f64(), stage });
        }
    };
    match answer {
        Some(mut answer) => {
            worker.end();
            worker.explain(&mut answer);
            Ok(answer)
        }
        None => Err(worker.fate(order.memory, stage)),
    }
}

/// A process at work.
struct Worker {
    child: Child,
    words: Receiver<Result<Word, serde_json::Error>>,
    last_words: JoinHandle<String>,
}

impl Worker {
    fn start(order: &Order, scratch: &std::path::Path) -> std::io::Result<Self> {
        let mut command = Command::new(system::this_program()?);
        // Folders of the task's own vanish with this one, however the process ends.
        command.arg(WORKER).env("TMPDIR", scratch);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        system::lead_group(&mut command);
        let mut child = command.spawn()?;
        let text = serde_json::to_string(order).map_err(std::io::Error::other)?;
        // Its input stays open: the worker ends when it closes. One that is gone already says why by itself.
        if let Some(input) = child.stdin.as_mut() {
            let _ = writeln!(input, "{text}");
        }
        let (tell, words) = channel();
        if let Some(output) = child.stdout.take() {
            std::thread::spawn(move || {
                for line in BufReader::new(output).lines().map_while(Result::ok) {
                    if tell.send(serde_json::from_str(&line)).is_err() {
                        break;
                    }
                }
            });
        }
        let errors = child.stderr.take();
        let last_words = std::thread::spawn(move || errors.map(last_words).unwrap_or_default());
        Ok(Self { child, words, last_words })
    }

    fn end(&mut self) {
        system::end(&mut self.child);
    }

    /// Puts where a panic was into the report that tells of it.
    fn explain(self, answer: &mut Word) {
        if let Word::Ran(report) = answer
            && report.code == code::INTERNAL
            && let Some(failure) = &mut report.failure
        {
            let words = self.last_words.join().unwrap_or_default();
            failure.message = format!("{}: {}", failure.message, words.trim());
        }
    }

    /// Why it gave no answer.
    fn fate(mut self, memory: Option<u64>, stage: Option<Stage>) -> PartError {
        let status = self.settled();
        self.end();
        let words = self.last_words.join().unwrap_or_default();
        let no_memory = words.contains(NO_MEMORY) || status.is_some_and(system::was_killed);
        if no_memory {
            return PartError::OutOfMemory { bytes: memory.unwrap_or(0), stage };
        }
        let status = status.map_or_else(|| "no end".to_owned(), |status| status.to_string());
        let words = words.trim();
        let words = if words.is_empty() { status } else { format!("{status}: {words}") };
        PartError::Crash { stage, words }
    }

    /// How it ended by itself; a process that closed its output has little time left to.
    fn settled(&mut self) -> Option<ExitStatus> {
        // Not by waiting, which closes its input: a worker whose input is closed ends itself.
        let deadline = Instant::now() + SETTLING;
        while Instant::now() < deadline {
            match self.child.try_wait() {
                Ok(None) => std::thread::sleep(Duration::from_millis(5)),
                Ok(status) => return status,
                Err(_) => return None,
            }
        }
        None
    }
}

/// The end of a stream.
fn last_words(mut stream: impl Read) -> String {
    let (mut kept, mut buffer) = (Vec::new(), [0; 1024]);
    while let Ok(count @ 1..) = stream.read(&mut buffer) {
        kept.extend_from_slice(&buffer[..count]);
        let excess = kept.len().saturating_sub(KEPT);
        kept.drain(..excess);
    }
    String::from_utf8_lossy(&kept).into_owned()
}
