//! Plays a scenario: what happens to the machine, held against what is expected of it.

use super::frame::Frame;
use super::run::{Program, Run};
use crate::base::Span;
use crate::ir::chart::Machine;
use crate::ir::scenario::{Condition, Doing, Given, Happening, Scenario, Seen, Step, Told};

/// How a scenario went.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// How many scans ran.
    pub scans: u64,
    /// What went wrong first, if something did.
    pub failure: Option<Failure>,
    /// The values at the end, with what was hidden then.
    pub last: Frame,
}

/// Why a scenario failed, and when.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// What was expected.
    pub kind: Expectation,
    /// The line that expected it.
    pub span: Span,
    /// Its text.
    pub text: String,
    /// The scan, counted from 1; nothing has run where it is 0.
    pub scan: u64,
    /// Whether it was seen after that scan, in what happens in the plant before the next one.
    pub between: bool,
    /// What the condition reads, with the values after that scan.
    pub values: Vec<(String, bool)>,
}

/// What a line expects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expectation {
    /// The condition, after the last scan.
    Now,
    /// The condition, within that many scans.
    Within(u32),
    /// The condition, in each scan.
    Always,
    /// The opposite of the condition, in each scan.
    Never,
    /// That the plant can take the step then.
    Happens,
    /// That outputs still wait to be written.
    BeforeWriting,
}

/// Something that a scenario comes to see.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// How many scans have run.
    pub scan: u64,
    /// What has happened since the last one, if this is not its end.
    pub happens: Option<&'a str>,
    /// The values.
    pub frame: &'a Frame,
}

/// Plays the scenario of that index and stops at the first failure. `each` sees every scan's frame.
pub fn play(machine: &Machine, program: Program, scenario: usize, each: &mut dyn FnMut(u64, &Frame)) -> Verdict {
    watch(machine, program, scenario, &mut |moment| {
        if moment.happens.is_none() {
            each(moment.scan, moment.frame);
        }
    })
}

/// The same for who wants to see what the scenario lets happen between scans, too.
pub fn watch(machine: &Machine, program: Program, scenario: usize, each: &mut dyn FnMut(Moment<'_>)) -> Verdict {
    let mut player = Player { run: Run::new(machine, program), watches: Vec::new(), told: false, each };
    let mut failure = None;
    for scenario in chain(machine, scenario) {
        player.told = scenario.tells();
        failure = player.steps(&scenario.steps).err();
        if failure.is_some() {
            break;
        }
    }
    Verdict { scans: player.run.scans(), failure: failure.map(|f| *f), last: player.run.moment().clone() }
}

/// The scenario with those that are played before it, first first.
fn chain(machine: &Machine, scenario: usize) -> Vec<&Scenario> {
    let mut chain: Vec<&Scenario> =
        std::iter::successors(Some(&machine.scenarios[scenario]), |s| s.after.map(|a| &machine.scenarios[a])).collect();
    chain.reverse();
    chain
}

struct Player<'m, 'e> {
    run: Run<'m>,
    /// What `always` and `never` have begun to watch, with the line.
    watches: Vec<(&'m Condition, bool, &'m Step)>,
    /// Whether nothing happens in the plant by itself.
    told: bool,
    each: &'e mut dyn FnMut(Moment<'_>),
}

type Played = Result<(), Box<Failure>>;

impl<'m> Player<'m, '_> {
    fn steps(&mut self, steps: &'m [Step]) -> Played {
        steps.iter().try_for_each(|step| self.step(step))
    }

    fn step(&mut self, step: &'m Step) -> Played {
        match &step.doing {
            Doing::Set(values) => {
                for &(given, value) in values {
                    self.run.plant().set(given, value);
                }
                Ok(())
            }
            Doing::Press(given, scans) => self.press(given, *scans),
            Doing::Force(values) => {
                for &(input, value) in values {
                    self.run.plant().force(input, Some(value));
                }
                Ok(())
            }
            Doing::Release(inputs) => {
                for &input in inputs {
                    self.run.plant().force(input, None);
                }
                Ok(())
            }
            Doing::Place(actuator, position) => {
                let machine = self.run.machine();
                self.run.plant().place(machine, *actuator, *position);
                Ok(())
            }
            Doing::Happens(None) => Ok(()),
            Doing::Happens(Some(told)) => self.happen(*told, step),
            Doing::Wait(scans) => (0..*scans).try_for_each(|_| self.scan()),
            Doing::Until(condition, within) => {
                for _ in 0..*within {
                    self.scan()?;
                    if self.run.holds(condition) {
                        return Ok(());
                    }
                }
                Err(self.failure(Expectation::Within(*within), step, condition))
            }
            Doing::Expect(condition) if self.run.holds(condition) => Ok(()),
            Doing::Expect(condition) => Err(self.failure(Expectation::Now, step, condition)),
            Doing::Watch(condition, value) => {
                self.watches.push((condition, *value, step));
                Ok(())
            }
            Doing::Repeat(times, steps) => (0..*times).try_for_each(|_| self.steps(steps)),
        }
    }

    /// A press is an edge: what is pressed takes the other value, and then again the one that it had. It had that in
    /// the scan before, too, or there was none yet.
    fn press(&mut self, given: &[Given], scans: u32) -> Played {
        let layout = *self.run.layout();
        let rest: Vec<(Given, bool)> = given.iter().map(|&g| (g, self.run.given()[layout.place(g)])).collect();
        if self.run.scans() == 0 || rest.iter().any(|&(g, value)| self.run.frame()[layout.place(g)] != value) {
            self.scan()?;
        }
        for &(g, value) in &rest {
            self.run.plant().set(g, !value);
        }
        (0..scans).try_for_each(|_| self.scan())?;
        for &(g, value) in &rest {
            self.run.plant().set(g, value);
        }
        Ok(())
    }

    fn scan(&mut self) -> Played {
        let possible = self.write()?;
        for happening in possible.into_iter().filter(|_| !self.told) {
            if self.run.happen(happening) {
                self.watch()?;
            }
        }
        self.run.read();
        (self.each)(Moment { scan: self.run.scans(), happens: None, frame: self.run.frame() });
        self.watch()
    }

    /// Lets outputs be written. Returns what may happen then.
    fn write(&mut self) -> Result<Vec<usize>, Box<Failure>> {
        let before = self.run.moment().clone();
        let possible = self.run.write();
        if *self.run.moment() != before {
            self.tell("outputs are written");
            self.watch()?;
        }
        Ok(possible)
    }

    fn happen(&mut self, told: Told, step: &Step) -> Played {
        let Happening { condition, text, .. } = &self.run.machine().plant.happenings[told.happening];
        if !told.before_writing {
            self.write()?;
        } else if !self.run.plant().waits() {
            return Err(self.failure(Expectation::BeforeWriting, step, condition));
        }
        if !self.run.happen(told.happening) {
            return Err(self.failure(Expectation::Happens, step, condition));
        }
        self.tell(&if told.before_writing { format!("{text} before writing") } else { text.clone() });
        self.watch()
    }

    /// Shows what a scenario that tells it has let happen.
    fn tell(&mut self, happens: &str) {
        if self.told {
            (self.each)(Moment { scan: self.run.scans(), happens: Some(happens), frame: self.run.moment() });
        }
    }

    /// Looks at what is always or never so.
    fn watch(&self) -> Played {
        for &(condition, value, step) in &self.watches {
            if !self.looks_at(condition) {
                continue;
            }
            if self.run.holds(condition) != value {
                let kind = if value { Expectation::Always } else { Expectation::Never };
                return Err(self.failure(kind, step, condition));
            }
        }
        Ok(())
    }

    /// Whether this is a moment to look at a condition. Between scans those are looked at that read something hidden, unless they read
    /// how it came to that, too: between them there is no scan before, and no event. Before the first scan all has to be hidden.
    fn looks_at(&self, condition: &Condition) -> bool {
        let (mut some, mut all, mut of_scans) = (false, true, false);
        condition.for_each_atom(&mut |&seen| {
            let hidden = self.run.machine().is_hidden(seen);
            some |= hidden || matches!(seen, Seen::Compare(_));
            all &= hidden;
            of_scans |= seen.is_of_scans();
        });
        !self.run.is_between() || some && !of_scans && (all || self.run.scans() > 0)
    }

    fn failure(&self, kind: Expectation, step: &Step, condition: &Condition) -> Box<Failure> {
        Box::new(Failure {
            kind,
            span: step.span,
            text: step.text.clone(),
            scan: self.run.scans(),
            between: self.run.is_between(),
            values: self.run.values(condition),
        })
    }
}
