//! Small machines by chance, with plants of all kinds: so few states that somebody can go through all of them.
//!
//! The generator of [`random`](super::random) makes charts that have all that the language knows; this one makes closed
//! loops. What it makes need not be valid: who uses it leaves out what the compiler refuses.

use super::rng::Rng;
use std::fmt::Write;

/// A small machine.
pub struct Small {
    rng: Rng,
    /// How its plant moves.
    plant: Plant,
    /// The inputs that nobody gives.
    free: Vec<String>,
    /// The inputs that rules of the plant give.
    given: Vec<String>,
    /// All outputs.
    outputs: Vec<String>,
    /// For each actuator, its technology and its outputs.
    actuators: Vec<(&'static str, Vec<usize>)>,
    /// Whether it has a variable, an event and an integer.
    variable: bool,
    event: bool,
    integer: bool,
    /// Hidden bits of the plant, and whether it counts.
    hidden: Vec<String>,
    counts: bool,
    observer: Option<String>,
    charts: String,
    safety: String,
    reset: bool,
    constraints: Vec<String>,
    plants: String,
    /// The properties, each with whether it can be asked of any program.
    properties: Vec<(String, bool)>,
    timers: usize,
}

/// How a plant moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plant {
    None,
    ByScans,
    BySteps,
}

/// What a condition may read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reads {
    Observer,
    AfterFilter,
    Guard,
    Constraint,
    Rule,
    Step,
    Valve,
    Property,
}

impl Small {
    /// The machine of that seed.
    pub fn new(seed: u64) -> Small {
        let mut rng = Rng::new(seed ^ 0x736d_616c_6c00);
        let plant = *rng.pick(&[Plant::None, Plant::ByScans, Plant::ByScans, Plant::BySteps, Plant::BySteps]);
        let mut small = Small {
            plant,
            free: (0..rng.between(1, 2)).map(|i| format!("In{i}")).collect(),
            given: Vec::new(),
            outputs: Vec::new(),
            actuators: Vec::new(),
            variable: rng.chance(30),
            event: rng.chance(20),
            integer: rng.chance(20),
            hidden: Vec::new(),
            counts: plant == Plant::BySteps && rng.chance(50),
            observer: None,
            charts: String::new(),
            safety: String::new(),
            reset: false,
            constraints: Vec::new(),
            plants: String::new(),
            properties: Vec::new(),
            timers: 0,
            rng,
        };
        for _ in 0..small.rng.between(1, 2) {
            let technology = *small.rng.pick(&["onoff", "monostable", "bistable"]);
            let many = if technology == "bistable" { 2 } else { 1 };
            let first = small.outputs.len();
            small.outputs.extend((first..first + many).map(|o| format!("Out{o}")));
            small.actuators.push((technology, (first..first + many).collect()));
        }
        if plant != Plant::None {
            small.given = (0..small.rng.below(2)).map(|i| format!("Given{i}")).collect();
            small.hidden = (0..small.rng.between(usize::from(!small.counts), 2)).map(|i| format!("Hid{i}")).collect();
        }
        small.observe();
        small.plant();
        small.charts();
        small.safety();
        small.properties();
        small
    }

    /// How its plant moves.
    pub fn kind(&self) -> Plant {
        self.plant
    }

    /// The machine with its charts.
    pub fn source(&self) -> String {
        self.text("", &self.charts, |_| true)
    }

    /// The machine with charts that do whatever they are told by more inputs, `Free…`, so far as a chart can: who
    /// runs it lets the state `Anything.Go` drive each output by the input that is called `Free` and its name.
    pub fn any(&self) -> String {
        let mut inputs: String = self.outputs.iter().map(|o| format!(" Free{o}")).collect();
        let mut charts = "chart Anything { initial state Go".to_owned();
        if self.variable {
            inputs += " FreeMem";
            charts += " { sets Mem when FreeMem resets Mem when not FreeMem }";
        }
        charts += " }\n";
        if self.event {
            inputs += " FreeEv";
            charts += "chart AnyEvent {\n  initial choice Begin { when FreeEv to Yes else to No }\n  \
                       state Yes { entry raise Ev }\n  state No\n  from Yes to Begin\n  from No to Begin\n}\n";
        }
        if self.integer {
            inputs += " FreeLow FreeHigh";
            charts += "chart AnyNumber {\n  initial choice Pick { when FreeHigh to Two when FreeLow to One else to Nought }\n";
            for (value, name) in ["Nought", "One", "Two"].iter().enumerate() {
                let _ = writeln!(charts, "  state {name} {{ entry set Num := {value} }}\n  from {name} to Pick");
            }
            charts += "}\n";
        }
        self.text(&inputs, &charts, |any| any)
    }

    fn text(&self, more: &str, charts: &str, asks: impl Fn(bool) -> bool) -> String {
        let mut out = "machine Small\ncycle 10ms\ninputs {".to_owned();
        let sensors = (0..self.actuators.len()).filter(|&a| self.travels(a)).flat_map(|a| [0, 1].map(|p| sensor(a, p)));
        for input in self.free.iter().chain(&self.given).cloned().chain(sensors) {
            let _ = write!(out, " {input}");
        }
        let _ = writeln!(out, "{more} }}\noutputs {{ {} }}", self.outputs.join(" "));
        if self.variable {
            out += "variables { Mem : BOOL }\n";
        }
        if self.integer {
            out += "variables { Num : 0..2 }\n";
        }
        if self.event {
            out += "events { Ev }\n";
        }
        for (a, (technology, outputs)) in self.actuators.iter().enumerate() {
            let _ = writeln!(out, "actuator Act{a} {technology} {{");
            for p in [0, 1] {
                let output = match outputs[..] {
                    [only] if p == 1 => format!(" output Out{only}"),
                    [first, second] => format!(" output Out{}", [first, second][p]),
                    _ => String::new(),
                };
                let sensor = if self.travels(a) { format!(" sensor {}", sensor(a, p)) } else { String::new() };
                let _ = writeln!(out, "  position Pos{p}{output}{sensor}");
            }
            out += "}\n";
        }
        out += self.observer.as_deref().unwrap_or_default();
        out += charts;
        out += &self.safety;
        out += &self.plants;
        let properties = self.properties.iter().filter(|(_, any)| asks(*any));
        let properties: String = properties.map(|(text, _)| format!("  {text}\n")).collect();
        if !properties.is_empty() {
            let _ = writeln!(out, "properties {{\n{properties}}}");
        }
        out
    }

    /// Whether the actuator travels: the second of two does not.
    fn travels(&self, actuator: usize) -> bool {
        self.plant != Plant::None && actuator == 0 && self.actuators[0].0 != "onoff"
    }

    /// One thing that a condition may read, or its opposite.
    fn literal(&mut self, reads: Reads) -> String {
        let mut inputs = [self.free.clone(), self.given.clone()].concat();
        if self.travels(0) {
            inputs.extend([sensor(0, 0), sensor(0, 1)]);
        }
        let input = self.rng.pick(&inputs).clone();
        let output = self.rng.pick(&self.outputs).clone();
        let past = |rng: &mut Rng, of: &str| format!("{}({of})", rng.pick(&["prev", "rise", "fall"]));
        let hidden = if self.hidden.is_empty() { None } else { Some(self.rng.pick(&self.hidden).clone()) };
        let count = self.counts.then(|| format!("Cnt {} {}", self.rng.pick(&["=", "<", ">="]), self.rng.between(1, 2)));
        let number = self.integer.then(|| format!("Num {} 1", self.rng.pick(&["=", "<", ">"])));
        let observer = self.observer.is_some() && reads != Reads::Observer;
        let constraint = self.rng.choose(&(0..self.constraints.len()).collect::<Vec<_>>());
        let state = self.rng.below(2);
        let text = match (reads, self.rng.below(12)) {
            (Reads::Valve, _) => output,
            (Reads::Step, 0..=3) => output,
            (Reads::Step, 4..=5) => input,
            (Reads::Step, _) => match (count, hidden) {
                (Some(count), None) => count,
                (Some(count), Some(hidden)) => self.rng.pick(&[count, hidden]).clone(),
                (None, hidden) => hidden.expect("it counts, or hides a bit"),
            },
            (Reads::Rule, 0..=2) => output,
            (Reads::Rule, 3..=4) => past(&mut self.rng, &output),
            (Reads::Rule, 5) => past(&mut self.rng, &input),
            (Reads::Rule, 6) => input,
            (Reads::Rule, 7..=8) => count.or(hidden).unwrap_or(output),
            (Reads::Rule, 9) => hidden.map(|h| past(&mut self.rng, &h)).unwrap_or(output),
            (Reads::Rule, _) => hidden.unwrap_or(input),
            (_, 0..=2) => input,
            (_, 3) => past(&mut self.rng, &input),
            (Reads::AfterFilter | Reads::Property, 4) => past(&mut self.rng, &output),
            (Reads::AfterFilter | Reads::Property, 5) => output,
            (_, 4) => format!("prev({output})"),
            (Reads::Observer | Reads::AfterFilter, _) => input,
            (_, 6) if observer => format!("in(Watch.Seen{state})"),
            (_, 7) if self.variable => "Mem".to_owned(),
            (_, 8) if self.event => "Ev".to_owned(),
            (_, 9) if self.integer => number.expect("there is an integer"),
            (Reads::Property, 6) => hidden.map(|h| past(&mut self.rng, &h)).unwrap_or(output),
            (Reads::Property, 7..=8) => hidden.or(count).unwrap_or(output),
            (Reads::Property, 9) => match constraint {
                Some(c) => {
                    let name = self.constraints[c].clone();
                    let word = if self.reset { *self.rng.pick(&["acts", "first"]) } else { "acts" };
                    format!("{word}({name})")
                }
                None => output,
            },
            (Reads::Property, _) => count.or(hidden).unwrap_or(output),
            (Reads::Guard, 10) => format!("in(Main.S{state})"),
            _ => input,
        };
        if self.rng.chance(40) { format!("not {}", bracketed(&text)) } else { text }
    }

    /// A condition of one to three literals.
    fn condition(&mut self, reads: Reads) -> String {
        let first = self.literal(reads);
        match self.rng.below(10) {
            0..=5 => first,
            6..=7 => format!("{first} and {}", self.literal(reads)),
            8 => format!("({first} or {})", self.literal(reads)),
            _ => {
                let (a, b) = (self.literal(reads), self.literal(reads));
                format!("{first} and ({a} {} {b})", self.rng.pick(&["or", "xor"]))
            }
        }
    }

    fn observe(&mut self) {
        if self.rng.chance(60) {
            return;
        }
        let mut text = "observer Watch {\n  initial state Seen0\n  state Seen1\n".to_owned();
        let late = self.rng.chance(50);
        let (to, back) = (self.condition(Reads::Observer), self.condition(Reads::Observer));
        if late {
            let after = self.condition(Reads::AfterFilter);
            let _ = writeln!(text, "  after filter {{ from Seen0 to Seen1 when {after} }}");
        } else {
            let _ = writeln!(text, "  from Seen0 to Seen1 when {to}");
        }
        if self.timers == 0 && !late && self.rng.chance(30) {
            self.timers += 1;
            text += "  from Seen1 to Seen0 when after 20ms\n}\n";
        } else {
            let _ = writeln!(text, "  from Seen1 to Seen0 when {back}\n}}");
        }
        self.observer = Some(text);
    }

    fn plant(&mut self) {
        if self.plant == Plant::None {
            return;
        }
        let by_steps = self.plant == Plant::BySteps;
        let mut text = format!("plant {}{{\n", if by_steps { "by steps " } else { "" });
        for hidden in &self.hidden {
            let _ = writeln!(text, "  hidden {hidden}");
        }
        if self.counts {
            let _ = writeln!(text, "  hidden Cnt : 0..2{}", self.rng.pick(&["", " := 1"]));
        }
        let mut begins = String::new();
        for name in self.hidden.iter().chain(&self.given) {
            match self.rng.below(6) {
                0 if name.starts_with("Hid") => begins += &format!(" any {name}"),
                1 => begins += &format!(" set {name}"),
                _ => {}
            }
        }
        if self.travels(0) {
            if self.rng.chance(25) {
                begins += " place Act0 at Pos1";
            }
            let times = ["10ms", "30ms"];
            let (out, back) = (*self.rng.pick(&times), *self.rng.pick(&times));
            let driven = if self.actuators[0].0 == "bistable" && self.rng.chance(40) { " while driven" } else { "" };
            let power = if self.rng.chance(30) {
                format!(" when {}", self.condition(if by_steps { Reads::Step } else { Reads::Rule }))
            } else {
                String::new()
            };
            let _ = writeln!(text, "  Act0 travels {out} back {back}{driven}{power}");
        }
        if !begins.is_empty() {
            let _ = writeln!(text, "  initially {{{begins} }}");
        }
        for target in self.hidden.clone().into_iter().chain(self.given.clone()) {
            let hides = target.starts_with("Hid");
            for _ in 0..self.rng.between(usize::from(!hides), 2) {
                let reads = if hides && self.rng.chance(40) { Reads::Valve } else { Reads::Rule };
                let condition = self.condition(reads);
                let change = *self.rng.pick(&["follows", "rises when", "falls when"]);
                let after = if self.rng.chance(20) { " after 20ms" } else { "" };
                let _ = writeln!(text, "  {target} {change} {condition}{after}");
            }
        }
        if by_steps {
            for i in 0..self.rng.between(1, 3) {
                let when = self.condition(Reads::Step);
                let mut outcomes = Vec::new();
                for outcome in 0..self.rng.between(1, 2) {
                    let what = match self.hidden.choose_one(&mut self.rng) {
                        Some(bit) if !self.counts || self.rng.chance(50) => {
                            format!("{} {bit}", self.rng.pick(&["set", "reset"]))
                        }
                        _ => format!("set Cnt := {}", self.rng.pick(&["Cnt + 1", "Cnt - 1", "0", "2 - Cnt"])),
                    };
                    let when = if outcome > 0 || self.rng.chance(40) {
                        format!(" when {}", self.condition(Reads::Step))
                    } else {
                        String::new()
                    };
                    outcomes.push(what + &when);
                }
                let _ = writeln!(text, "  step \"number {i}\" when {when} then {}", outcomes.join(", "));
            }
        }
        self.plants = text + "}\n";
    }

    /// A guard, which now and then waits for a time.
    fn guard(&mut self) -> String {
        let guard = self.condition(Reads::Guard);
        match self.rng.below(12) {
            0 if self.timers < 2 => {
                self.timers += 1;
                format!("after {}ms and {guard}", 10 * self.rng.between(1, 3))
            }
            1 if self.timers < 2 => {
                self.timers += 1;
                format!("after {}ms", 10 * self.rng.between(1, 3))
            }
            _ => guard,
        }
    }

    fn charts(&mut self) {
        let mut first = 0;
        if self.travels(0) && self.rng.chance(50) {
            let (out, back) = (self.guard(), self.guard());
            let _ = writeln!(
                self.charts,
                "chart Moves controls Act0 {{\n  initial state Pos0\n  state Pos1\n  \
                 move from Pos0 to Pos1 as Going when {out}\n  move from Pos1 to Pos0 as Coming when {back}\n}}"
            );
            first = self.actuators[0].1.len();
        }
        let states = self.rng.between(2, 3);
        let mut text = "chart Main {\n".to_owned();
        for s in 0..states {
            let mut inside = String::new();
            if self.rng.chance(70)
                && let Some(&output) = (first..self.outputs.len()).collect::<Vec<_>>().choose_one(&mut self.rng)
            {
                let when =
                    if self.rng.chance(40) { format!(" when {}", self.condition(Reads::Guard)) } else { String::new() };
                let _ = write!(inside, " drives Out{output}{when}");
            }
            if self.variable && self.rng.chance(25) {
                let _ =
                    write!(inside, " {} Mem when {}", self.rng.pick(&["sets", "resets"]), self.condition(Reads::Guard));
            }
            if self.event && self.rng.chance(20) {
                inside += " entry raise Ev";
            }
            if s == 1 && self.rng.chance(30) {
                let guard = self.guard();
                let _ = write!(
                    inside,
                    "\n    initial state Deep0\n    final state Deep1\n    from Deep0 to Deep1 when {guard}\n    "
                );
            }
            let braces = if inside.is_empty() { inside } else { format!(" {{{inside} }}") };
            let _ = writeln!(text, "  {}state S{s}{braces}", if s == 0 { "initial " } else { "" });
        }
        for s in 0..states {
            for way in 0..self.rng.between(1, 2) {
                let to = if way == 0 { (s + 1) % states } else { self.rng.below(states) };
                let guard = self.guard();
                let mut effects = Vec::new();
                if self.variable && self.rng.chance(30) {
                    effects.push(format!("{} Mem", self.rng.pick(&["set", "reset"])));
                }
                if self.event && self.rng.chance(30) {
                    effects.push("raise Ev".to_owned());
                }
                if self.integer && self.rng.chance(50) {
                    effects.push(format!("set Num := {}", self.rng.pick(&["Num + 1", "Num - 1", "0"])));
                }
                let then = if effects.is_empty() { String::new() } else { format!(" then {}", effects.join(", ")) };
                let _ = writeln!(text, "  from S{s} to S{to} when {guard}{then}");
            }
        }
        self.charts += &text;
        self.charts += "}\n";
    }

    fn safety(&mut self) {
        if self.rng.chance(35) {
            return;
        }
        let mode =
            *self.rng.pick(&["supervisor", "controller", "blocking", "supervisor reset", "supervisor relief in-order"]);
        self.reset = mode == "blocking" || mode == "supervisor reset";
        let by = if self.reset {
            format!("{} by In0", if mode == "blocking" { " reset" } else { "" })
        } else {
            String::new()
        };
        let mut text = format!("safety {mode}{by} {{\n");
        let ways: Vec<usize> = self.outputs.iter().map(|_| self.rng.below(3)).collect();
        let literal = |rng: &mut Rng, o: usize| match (ways[o], rng.below(3)) {
            (0, 0) | (2, 0) => format!("rise(Out{o})"),
            (0, _) => format!("Out{o}"),
            (1, _) => format!("not Out{o}"),
            _ => format!("fall(Out{o})"),
        };
        for i in 0..self.rng.between(1, 3) {
            let o = self.rng.below(self.outputs.len());
            let held = literal(&mut self.rng, o);
            let reading = self.literal(Reads::Constraint);
            let name = format!("C{i}");
            if self.outputs.len() > 1 && self.rng.chance(50) {
                let other = (o + 1) % self.outputs.len();
                let other = format!("{}Out{other}", self.rng.pick(&["", "not "]));
                let reading = if self.rng.chance(50) { format!(" and {reading}") } else { String::new() };
                let _ = writeln!(text, "  {name}: never {held} and {other}{reading} yields Out{o}");
            } else {
                let _ = writeln!(text, "  {name}: never {held} and {reading}");
            }
            self.constraints.push(name);
        }
        if self.rng.chance(40) {
            let never = self.condition(Reads::Observer);
            if !never.contains("Out") {
                let _ = writeln!(text, "  assume A0: never {never}");
            }
        }
        self.safety = text + "}\n";
    }

    fn properties(&mut self) {
        for i in 0..self.rng.between(2, 5) {
            let condition = self.condition(Reads::Property);
            let (text, any) = match self.rng.below(9) {
                0..=1 => (format!("P{i}: never {condition}"), true),
                2 => (format!("P{i}: always {condition}"), true),
                3 => (format!("P{i}: reachable {condition}"), true),
                4 => (format!("P{i}: always possible {condition}"), true),
                5 => (format!("P{i}: always possible in(Main.S1) and {condition}"), false),
                6 => (format!("P{i}: always eventually {condition}"), false),
                7 => (format!("P{i}: after in(Main.S1) eventually {condition}"), false),
                _ => (format!("P{i}: after {} eventually {condition}", self.condition(Reads::Property)), false),
            };
            self.properties.push((text, any));
        }
        if self.rng.chance(40) {
            let text = format!("assume F0: always eventually {}", self.condition(Reads::Property));
            self.properties.push((text, false));
        }
    }
}

/// The sensor of a position of an actuator.
fn sensor(actuator: usize, position: usize) -> String {
    format!("Sen{actuator}{position}")
}

fn bracketed(text: &str) -> String {
    if text.contains(' ') { format!("({text})") } else { text.to_owned() }
}

trait Choose<T> {
    fn choose_one(&self, rng: &mut Rng) -> Option<&T>;
}

impl<T> Choose<T> for Vec<T> {
    fn choose_one(&self, rng: &mut Rng) -> Option<&T> {
        if self.is_empty() { None } else { Some(rng.pick(self)) }
    }
}
