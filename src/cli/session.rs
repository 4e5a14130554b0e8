//! Lines of commands to a run by hand, and what each changes.

use super::{Outcome, files, told};
use crate::base::{self, iec};
use crate::ir::chart::{InputId, Machine};
use crate::ir::scenario::Given;
use crate::pipeline;
use crate::simulate::frame::Frame;
use crate::simulate::record::{Names, seconds};
use crate::simulate::run::{Program, Run, milliseconds};
use crate::simulate::tree;
use std::fmt::Write;
use std::io::{BufRead, IsTerminal};

/// After how many scans `run until` gives up.
const PATIENCE: u64 = 100_000;

const HELP: &str = "\
set A B        TRUE from the next scan on; reset A B: FALSE; toggle A B: the other value
press A B      the other value for one scan, which runs
release A B    no longer held: what the plant gives is the plant's again
step [N]       runs one scan, or N; so does an empty line
run until EXPR runs until the condition holds: run until in(Working) and not LAMP
back [N]       goes back one scan, or N, and forgets what was done since
tree           the active states
inputs         inputs and hidden bits with their values; `~` is given by the plant, `!` held against it
outputs        outputs and variables with their values
help           this
quit           ends
";

/// What was done to the machine before a scan, to do it again.
#[derive(Clone, Copy, Debug)]
enum Deed {
    Set(Given, bool),
    Force(InputId, Option<bool>),
}

/// Reads commands from standard input until there are no more.
pub fn run(source: &str, machine: &Machine, program: Program) -> Outcome {
    let mut session = Session {
        source,
        machine,
        names: Names::of(machine),
        gives: machine.plant.gives(machine.inputs.len()),
        held: vec![false; machine.inputs.len()],
        run: Run::new(machine, program.clone()),
        program,
        deeds: Vec::new(),
        shown: None,
    };
    let stdin = std::io::stdin();
    let prompt = stdin.is_terminal();
    let mut wrong = false;
    if prompt {
        // What cannot be printed is seen when a command is answered; so below.
        let _ = files::print(format!("{}: `help` lists the commands\n", machine.name).as_bytes());
    }
    let mut lines = stdin.lock().lines();
    loop {
        if prompt {
            let _ = files::print(b"> ");
        }
        let Some(Ok(line)) = lines.next() else { break };
        let words: Vec<&str> = line.split_whitespace().collect();
        if matches!(words[..], ["quit" | "exit" | "q"]) {
            break;
        }
        let answer = session.obey(&words);
        wrong |= answer.is_err();
        let text = answer.unwrap_or_else(|error| format!("{}\n", annotate_snippets::normalize_untrusted_str(&error)));
        let printed = files::print(text.as_bytes());
        if printed.is_err() {
            return told(printed);
        }
    }
    // Nobody corrects what a script says.
    if wrong && !prompt { Outcome::Wrong } else { Outcome::Fine }
}

struct Session<'a> {
    source: &'a str,
    machine: &'a Machine,
    names: Names,
    /// For each input, whether the plant gives it.
    gives: Vec<bool>,
    /// For each input, whether it is held against the plant.
    held: Vec<bool>,
    run: Run<'a>,
    program: Program,
    /// What was done, with the number of scans that had run.
    deeds: Vec<(u64, Deed)>,
    /// The frame that was shown last.
    shown: Option<Frame>,
}

impl Session<'_> {
    /// What a line brings about, or what is wrong with it.
    fn obey(&mut self, words: &[&str]) -> Result<String, String> {
        match words {
            [] | ["step" | "s"] => Ok(self.step(1)),
            ["step" | "s", n] => Ok(self.step(count(n)?)),
            ["back"] => self.back(1),
            ["back", n] => self.back(count(n)?),
            ["run", "until", condition @ ..] if !condition.is_empty() => self.until(&condition.join(" ")),
            ["set", names @ ..] if !names.is_empty() => self.change(names, |_| Some(true)),
            ["reset", names @ ..] if !names.is_empty() => self.change(names, |_| Some(false)),
            ["toggle", names @ ..] if !names.is_empty() => self.change(names, |now| Some(!now)),
            ["release", names @ ..] if !names.is_empty() => self.change(names, |_| None),
            ["press", names @ ..] if !names.is_empty() => self.press(names),
            ["tree"] => Ok(tree::show(self.machine, self.run.frame())),
            ["inputs"] => Ok(self.inputs()),
            ["outputs"] => Ok(self.outputs()),
            ["help" | "?"] => Ok(HELP.to_owned()),
            [other, ..] => Err(format!("`{other}` is no command with that many words; `help` lists them")),
        }
    }

    fn step(&mut self, scans: u64) -> String {
        let mut text = String::new();
        for _ in 0..scans {
            self.run.scan();
            text += &self.changes();
        }
        text
    }

    /// What the last scan changed, as a line; nothing if it changed nothing and others came before.
    fn changes(&mut self) -> String {
        let frame = self.run.frame().clone();
        let cells = self.names.changes(self.shown.as_ref(), &frame);
        let quiet = cells.iter().all(String::is_empty);
        self.shown = Some(frame);
        let time = seconds(milliseconds(self.machine, self.run.scans()));
        let cells: Vec<String> = cells.into_iter().filter(|c| !c.is_empty()).collect();
        let what = if quiet { "nothing changes".to_owned() } else { cells.join(" | ") };
        format!("{:>6}  {time:>9}  {what}\n", self.run.scans())
    }

    fn until(&mut self, text: &str) -> Result<String, String> {
        let asked = pipeline::condition(self.source, text).map_err(|found| {
            let first = found.iter().find(|d| d.severity() == crate::base::Severity::Error);
            first.map_or_else(|| "this is no condition".to_owned(), |d| d.message.clone())
        })?;
        let mut out = String::new();
        for _ in 0..PATIENCE {
            let before = self.shown.clone();
            self.run.scan();
            let line = self.changes();
            if before.as_ref() != self.shown.as_ref() {
                out += &line;
            }
            if self.run.holds_beside(&asked.machine, &asked.condition) {
                return Ok(out);
            }
        }
        Err(format!("{out}this did not happen in {PATIENCE} scans"))
    }

    /// Does what was done up to an earlier scan again.
    fn back(&mut self, scans: u64) -> Result<String, String> {
        let Some(target) = self.run.scans().checked_sub(scans) else {
            return Err(format!("{} can be taken back", base::count(self.run.scans(), "scan")));
        };
        let deeds: Vec<(u64, Deed)> = self.deeds.iter().copied().filter(|(at, _)| *at < target).collect();
        self.run = Run::new(self.machine, self.program.clone());
        self.held.fill(false);
        self.deeds.clear();
        self.shown = None;
        let mut next = deeds.into_iter().peekable();
        while self.run.scans() < target {
            while let Some((_, deed)) = next.next_if(|(at, _)| *at == self.run.scans()) {
                self.act(deed);
            }
            self.run.scan();
        }
        if target > 0 {
            self.shown = Some(self.run.frame().clone());
        }
        let time = seconds(milliseconds(self.machine, target));
        Ok(format!("{target:>6}  {time:>9}  as it was\n"))
    }

    fn act(&mut self, deed: Deed) {
        self.deeds.push((self.run.scans(), deed));
        match deed {
            Deed::Set(given, value) => self.run.plant().set(given, value),
            Deed::Force(input, value) => {
                self.held[input.index()] = value.is_some();
                self.run.plant().force(input, value);
            }
        }
    }

    fn find(&self, name: &str) -> Result<Given, String> {
        let name = name.trim_end_matches(',');
        let folded = iec::fold(name);
        let input = self.machine.inputs.iter().find(|(_, i)| iec::fold(&i.name) == folded);
        let bit = self.machine.plant.bits.iter().find(|(_, b)| iec::fold(&b.name) == folded);
        let given = input.map(|(id, _)| Given::Input(id)).or(bit.map(|(id, _)| Given::Bit(id)));
        given.ok_or_else(|| format!("there is no input `{name}`; `inputs` lists them"))
    }

    /// Gives values; what the plant gives is held against it, or held no more for no value.
    fn change(&mut self, names: &[&str], value: impl Fn(bool) -> Option<bool>) -> Result<String, String> {
        let given: Vec<Given> = names.iter().map(|n| self.find(n)).collect::<Result<_, _>>()?;
        for given in given {
            let place = self.run.layout().place(given);
            let value = value(self.run.given()[place]);
            let deed = match (given, value) {
                (Given::Input(input), value) if self.gives[input.index()] => Deed::Force(input, value),
                (given, Some(value)) => Deed::Set(given, value),
                (given, None) => return Err(format!("`{}` is not the plant's", self.machine.given(given))),
            };
            self.act(deed);
        }
        Ok(String::new())
    }

    fn press(&mut self, names: &[&str]) -> Result<String, String> {
        let given: Vec<Given> = names.iter().map(|n| self.find(n)).collect::<Result<_, _>>()?;
        let rest: Vec<bool> = given.iter().map(|&g| self.run.given()[self.run.layout().place(g)]).collect();
        self.change(names, |now| Some(!now))?;
        let text = self.step(1);
        for (given, value) in given.into_iter().zip(rest) {
            let deed = match given {
                Given::Input(input) if self.gives[input.index()] => Deed::Force(input, None),
                given => Deed::Set(given, value),
            };
            self.act(deed);
        }
        Ok(text)
    }

    fn inputs(&self) -> String {
        let mut text = String::new();
        let inputs = self.machine.inputs.iter().map(|(id, i)| (Given::Input(id), &i.name, &i.description));
        let bits = self.machine.plant.bits.iter().map(|(id, b)| (Given::Bit(id), &b.name, &b.description));
        for (given, name, description) in inputs.chain(bits) {
            let mark = match given {
                Given::Input(i) if self.held[i.index()] => '!',
                Given::Input(i) if !self.gives[i.index()] => ' ',
                Given::Input(_) | Given::Bit(_) => '~',
            };
            let value = self.run.given()[self.run.layout().place(given)];
            let _ = writeln!(text, "{}", format!("{} {mark}{name:<12} {description}", u8::from(value)).trim_end());
        }
        for (id, c) in self.machine.plant.counts.iter() {
            let line = format!("{} ~{:<12} {}", self.run.count(id), c.name, c.description);
            let _ = writeln!(text, "{}", line.trim_end());
        }
        text
    }

    fn outputs(&self) -> String {
        let mut text = String::new();
        let (frame, layout) = (self.run.frame(), self.run.layout());
        for (id, o) in self.machine.outputs.iter() {
            let line = format!("{}  {:<12} {}", u8::from(frame[layout.output(id)]), o.name, o.description);
            let _ = writeln!(text, "{}", line.trim_end());
        }
        for (id, v) in self.machine.variables.iter() {
            let line = format!("{}  {:<12} {}", u8::from(frame[layout.variable(id)]), v.name, v.description);
            let _ = writeln!(text, "{}", line.trim_end());
        }
        for (id, e) in self.machine.events.iter() {
            let line = format!("{}  {:<12} {}", u8::from(frame[layout.event(id)]), e.name, e.description);
            let _ = writeln!(text, "{}", line.trim_end());
        }
        for (id, i) in self.machine.integers.iter() {
            let line = format!("{}  {:<12} {}", layout.integer(id, frame), i.name, i.description);
            let _ = writeln!(text, "{}", line.trim_end());
        }
        text
    }
}

fn count(word: &str) -> Result<u64, String> {
    match word.parse() {
        Ok(n @ 1..=PATIENCE) => Ok(n),
        _ => Err(format!("`{word}` is no number from 1 to {PATIENCE}")),
    }
}
