//! A long command to its end in time: the limit, Ctrl-C, and a line that says where it is.
//!
//! Who works asks now and then whether to [stop](Watch::stop), and that is when the line is drawn anew: on a terminal, once a second has
//! passed. So no thread is needed beside the one that works.

use crate::verify::{Engine, Progress};
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::cell::{Cell, RefCell};
use std::io::{IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, mpsc};
use std::thread;
use std::time::{Duration, Instant};

/// How long nothing is said.
const QUIET: Duration = Duration::from_secs(1);

/// How long a line stands at least.
const STANDS: Duration = Duration::from_millis(200);

/// The exit code of who is broken off for the second time: that of a program which Ctrl-C ends.
const BROKEN_OFF: i32 = 130;

/// The most characters of a line, so that it fits into any terminal and can be taken away again.
const WIDTH: usize = 79;

/// The stack of a thread that works beside the clock.
const STACK: usize = 256 << 20;

/// Watches over one command.
pub struct Watch {
    begun: Instant,
    /// How long it may take, if there is a limit.
    most: Option<Duration>,
    /// When to stop; not later than what the limit says.
    until: Cell<Option<Instant>>,
    interrupted: Arc<AtomicBool>,
    line: RefCell<Line>,
}

/// The line on the terminal.
struct Line {
    /// Whether there is somebody who reads it.
    wanted: bool,
    command: &'static str,
    /// What is being done.
    doing: String,
    drawn: Option<Instant>,
}

impl Watch {
    /// Begins. The command is to end after so many seconds; only one that speaks to people shows where it is.
    pub fn new(command: &'static str, seconds: Option<u64>, human: bool) -> Watch {
        let begun = Instant::now();
        let most = seconds.map(Duration::from_secs);
        let wanted = human && std::io::stderr().is_terminal();
        Watch {
            begun,
            most,
            // What lies beyond the end of the clock is no limit.
            until: Cell::new(most.and_then(|most| begun.checked_add(most))),
            interrupted: Arc::new(AtomicBool::new(false)),
            line: RefCell::new(Line { wanted, command, doing: "reading the model".to_owned(), drawn: None }),
        }
    }

    /// From now on Ctrl-C, or a request to terminate, only asks to stop; the second one ends the process at once. Where that cannot be
    /// arranged, the first one does.
    pub fn listen(self) -> Watch {
        for signal in [SIGINT, SIGTERM] {
            let end = flag::register_conditional_shutdown(signal, BROKEN_OFF, Arc::clone(&self.interrupted));
            let _ = end.and_then(|_| flag::register(signal, Arc::clone(&self.interrupted)));
        }
        self
    }

    /// Whether to stop.
    pub fn stop(&self) -> bool {
        self.draw();
        self.interrupted() || self.until.get().is_some_and(|until| Instant::now() > until)
    }

    /// Whether somebody has asked to stop.
    pub fn interrupted(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }

    /// How long it has taken so far.
    pub fn elapsed(&self) -> Duration {
        self.begun.elapsed()
    }

    /// Gives what comes next one of so many parts of the time that is left.
    pub fn share(&self, parts: usize) {
        let now = Instant::now();
        let share = |end: Instant| end.saturating_duration_since(now) / u32::try_from(parts).unwrap_or(u32::MAX).max(1);
        let end = self.most.and_then(|most| self.begun.checked_add(most));
        self.until.set(end.map(|end| now + share(end)));
    }

    /// Says what is being done now.
    pub fn say(&self, doing: impl Into<String>) {
        self.line.borrow_mut().doing = doing.into();
        self.draw();
    }

    /// Says where the engines are.
    pub fn follow(&self, progress: Progress) {
        // What nobody reads is not put into words; engines tell often.
        if self.line.borrow().wanted && self.begun.elapsed() > QUIET {
            self.say(words(progress));
        }
    }

    /// What comes of work that knows of no end, which is done beside the clock; nothing when the time is up. The end of the process ends
    /// the work then. Where there is no thread for it, there is no clock.
    pub fn beside<T: Send + 'static>(&self, work: impl Fn() -> T + Clone + Send + 'static) -> Option<T> {
        let (say, hear) = mpsc::channel();
        let again = work.clone();
        // Where nobody listens any more, nobody wants to know.
        let worker = thread::Builder::new().stack_size(STACK).spawn(move || drop(say.send(work())));
        let Ok(worker) = worker else { return Some(again()) };
        loop {
            match hear.recv_timeout(STANDS / 4) {
                Ok(found) => return Some(found),
                Err(mpsc::RecvTimeoutError::Timeout) if self.stop() => return None,
                Err(mpsc::RecvTimeoutError::Timeout) => {}
                Err(mpsc::RecvTimeoutError::Disconnected) => match worker.join() {
                    Ok(()) => unreachable!("a worker that ends well says what it has found"),
                    Err(panic) => std::panic::resume_unwind(panic),
                },
            }
        }
    }

    fn draw(&self) {
        let mut line = self.line.borrow_mut();
        if !line.wanted {
            return;
        }
        let elapsed = self.begun.elapsed();
        if elapsed < QUIET || line.drawn.is_some_and(|drawn| drawn.elapsed() < STANDS) {
            return;
        }
        line.drawn = Some(Instant::now());
        let text = sentence(line.command, &line.doing, elapsed, self.most, self.interrupted());
        // What is not seen does no harm.
        let _ = write!(std::io::stderr().lock(), "\r\x1b[K{text}");
        let _ = std::io::stderr().flush();
    }
}

impl Drop for Watch {
    /// What is said next stands in place of the line.
    fn drop(&mut self) {
        if self.line.borrow().drawn.is_some() {
            let _ = write!(std::io::stderr().lock(), "\r\x1b[K");
        }
    }
}

/// The line: what is done, and how much of the time is over.
fn sentence(command: &str, doing: &str, elapsed: Duration, most: Option<Duration>, interrupted: bool) -> String {
    let end = match most {
        _ if interrupted => "; stopping".to_owned(),
        Some(most) => format!("; {} of {} s", elapsed.as_secs(), most.as_secs()),
        None => format!("; {} s", elapsed.as_secs()),
    };
    let room = WIDTH.saturating_sub(command.len() + 2 + end.chars().count());
    let doing: String = doing.chars().take(room).collect();
    format!("{command}: {doing}{end}")
}

/// Where the engines are, in words.
fn words(progress: Progress) -> String {
    let Progress { engine, scans, open, .. } = progress;
    let questions = if open == 1 { "1 question".to_owned() } else { format!("{open} questions") };
    let scans = match (engine, scans) {
        (_, 0) => String::new(),
        (Engine::Exact | Engine::Bounded, 1) => ", scan 1".to_owned(),
        (Engine::Exact | Engine::Bounded, n) => format!(", scan {n}"),
        (Engine::Proof | Engine::Chance | Engine::Scenario, n) => format!(", step {n}"),
    };
    let engine = match engine {
        Engine::Exact => "all situations",
        Engine::Bounded => "the first scans",
        Engine::Proof => "proofs",
        Engine::Chance => "runs by chance",
        Engine::Scenario => "scenarios",
    };
    format!("{questions} open; {engine}{scans}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_who_works_on_how_much_and_fits() {
        let at = |engine, scans, open| words(Progress { engine, claim: None, scans, open });
        assert_eq!(at(Engine::Exact, 12, 7), "7 questions open; all situations, scan 12");
        assert_eq!(at(Engine::Proof, 0, 1), "1 question open; proofs");
        let (elapsed, most) = (Duration::from_millis(3_900), Some(Duration::from_secs(60)));
        let line = |doing: &str, interrupted| sentence("verify", doing, elapsed, most, interrupted);
        assert_eq!(line("reading the model", false), "verify: reading the model; 3 of 60 s");
        assert_eq!(line("reading the model", true), "verify: reading the model; stopping");
        let long = line(&"ä".repeat(200), false);
        assert_eq!(long.chars().count(), WIDTH, "{long}");
        assert!(long.ends_with("; 3 of 60 s"), "{long}");
    }

    #[test]
    fn time_is_up_after_its_share() {
        let watch = Watch::new("verify", Some(1_000), false);
        assert!(!watch.stop());
        watch.share(usize::MAX);
        std::thread::sleep(Duration::from_millis(5));
        assert!(watch.stop() && !watch.interrupted());
        watch.share(1);
        assert!(!watch.stop());
        assert!(!Watch::new("verify", Some(u64::MAX), false).stop());
        assert!(Watch::new("verify", Some(0), false).until.get().is_some());
    }
}
