//! Transitions, drives and actions.

use super::super::items::Item;
use super::{Model, State, Technology};

impl Model {
    /// Ways into every state, then more.
    pub fn transitions(&mut self) {
        for region in 0..self.regions.len() {
            self.ways_in(region);
        }
        let composite: Vec<usize> = (0..self.states.len()).filter(|&s| self.can_be_done(s)).collect();
        for state in composite {
            if self.rng.chance(60) {
                self.when_done(state);
            }
        }
        let more = self.rng.below(self.states.len() + 1);
        for _ in 0..more {
            match self.rng.below(10) {
                0..=4 => self.beside(),
                5..=8 => self.across(),
                _ => self.any_out(),
            }
        }
        for state in 0..self.states.len() {
            let State { ways_out, movement, is_final, .. } = self.states[state];
            if ways_out == 0 && !movement && self.rng.chance(if is_final { 20 } else { 90 }) {
                self.last_way_out(state);
            }
        }
    }

    /// A transition from a state that has no other. So it may go without a guard: no other one of the
    /// same source comes too late.
    fn last_way_out(&mut self, source: usize) {
        let region = self.states[source].region;
        let states = self.regions[region].states.clone();
        if !self.states[source].regions.is_empty() || self.rng.chance(60) {
            let target = *self.rng.pick(&states);
            return if self.states[target].movement {
                self.plain(region, source, target)
            } else {
                self.connect(region, source, target)
            };
        }
        let Some(target) = self.same_position(source) else { return };
        let effects = self.effects(region);
        let (from, to) = (&self.states[source].name, &self.states[target].name);
        self.put(region, format!("from {from} to {to}{effects}"));
    }

    /// A tree of transitions from the initial state to all others of a region.
    fn ways_in(&mut self, region: usize) {
        let initial = self.regions[region].initial;
        let mut to: Vec<usize> = self.regions[region].states.iter().copied().filter(|&s| s != initial).collect();
        self.rng.shuffle(&mut to);
        let mut from = vec![initial];
        for target in to {
            let source = *self.rng.pick(&from);
            self.connect(region, source, target);
            from.push(target);
        }
        // A way back keeps it going.
        if from.len() > 1 && self.rng.chance(75) {
            let source = from[from.len() - 1];
            self.connect(region, source, initial);
        }
    }

    /// A transition inside a region, as a movement where that is due.
    fn connect(&mut self, region: usize, source: usize, target: usize) {
        let (from, to) = (self.states[source].position, self.states[target].position);
        let technology = self.regions[region].actuator.map(|a| self.actuators[a].technology);
        let moves = matches!((from, to), (Some(a), Some(b)) if a != b)
            && match technology {
                Some(Technology::Bistable) => true,
                Some(Technology::Monostable) => self.rng.chance(75),
                Some(Technology::OnOff) | None => false,
            };
        if moves { self.movement(region, source, target) } else { self.plain(region, source, target) }
    }

    fn movement(&mut self, region: usize, source: usize, target: usize) {
        let (from, to) = (self.states[source].name.clone(), self.states[target].name.clone());
        let usual = format!("{from}_to_{to}");
        let taken = usual.len() > 48 || self.states.iter().any(|s| s.name == usual);
        let (name, renamed) = if taken || self.rng.chance(50) {
            let name = format!("Move{}", self.number());
            (name.clone(), format!(" as {name}"))
        } else {
            (usual, String::new())
        };
        let (priority, effects) = (self.priority(), self.effects(region));
        let guard = self.timed(2);
        self.states[source].ways_out += 1;
        self.put(region, format!("move from {from} to {to}{renamed}{priority} when {guard}{effects}"));
        let state = self.states.len();
        self.states.push(State {
            name,
            region,
            regions: Vec::new(),
            is_final: false,
            position: None,
            movement: true,
            leads_to: self.states[target].position,
            ways_out: 1,
            lines: Vec::new(),
        });
        self.regions[region].states.push(state);
    }

    /// A transition that is written in the region of that number.
    fn plain(&mut self, region: usize, source: usize, target: usize) {
        let scope = self.scope(source, target).expect("both are in one region");
        let guard = match self.rng.below(100) {
            0..=3 if self.can_be_done(source) => String::new(),
            4..=6 if self.can_be_done(source) => format!(" when done and {}", self.guard(1)),
            // What would leave a composite state all the time would keep what is inside from moving.
            _ if !self.states[source].regions.is_empty() && self.rng.chance(70) => {
                let edge = *self.rng.pick(&["rise", "fall"]);
                format!(" when {edge}(In{}) and {}", self.rng.below(self.inputs), self.timed(1))
            }
            _ => format!(" when {}", self.timed(2)),
        };
        let (priority, effects) = (self.priority(), self.effects(scope));
        self.states[source].ways_out += 1;
        let (from, to) = (&self.states[source].name, &self.states[target].name);
        self.put(region, format!("from {from} to {to}{priority}{guard}{effects}"));
    }

    fn when_done(&mut self, source: usize) {
        let region = self.states[source].region;
        let Some(target) = self.same_position(source) else { return };
        let guard = match self.rng.below(5) {
            0..=1 => String::new(),
            2 => " when done".into(),
            3 => format!(" when done({})", self.states[source].name),
            _ => format!(" when done and {}", self.guard(1)),
        };
        let effects = self.effects(region);
        let (from, to) = (&self.states[source].name, &self.states[target].name);
        self.put(region, format!("from {from} to {to}{guard}{effects}"));
    }

    /// A state of the same region that may be reached without a movement; `source` itself at times.
    fn same_position(&mut self, source: usize) -> Option<usize> {
        let region = &self.regions[self.states[source].region];
        let bistable = region.actuator.is_some_and(|a| self.actuators[a].technology == Technology::Bistable);
        let fits = |&t: &usize| !bistable || self.states[t].position == self.states[source].position;
        let targets: Vec<usize> = region.states.iter().copied().filter(fits).collect();
        self.rng.choose(&targets)
    }

    fn beside(&mut self) {
        let source = self.rng.below(self.states.len());
        let region = self.states[source].region;
        let states = self.regions[region].states.clone();
        let target = if self.rng.chance(20) { source } else { *self.rng.pick(&states) };
        if self.states[source].movement || self.states[target].movement {
            self.plain(region, source, target);
        } else {
            self.connect(region, source, target);
        }
    }

    /// Between any two states that have a scope, at whatever levels.
    fn across(&mut self) {
        let (source, target) = (self.rng.below(self.states.len()), self.rng.below(self.states.len()));
        let Some(scope) = self.scope(source, target) else { return };
        if self.states[source].region == self.states[target].region {
            return self.connect(scope, source, target);
        }
        // It may be written in the scope or further in.
        let places: Vec<usize> = [source, target].map(|s| self.states[s].region).into_iter().chain([scope]).collect();
        let place = *self.rng.pick(&places);
        self.plain(place, source, target);
    }

    fn any_out(&mut self) {
        let region = self.rng.below(self.regions.len());
        let target = self.rng.below(self.states.len());
        let source = self.regions[region].initial;
        let Some(scope) = self.scope(source, target) else { return };
        let bistable =
            self.regions[region].actuator.is_some_and(|a| self.actuators[a].technology == Technology::Bistable);
        if bistable && self.states[target].region == region && !self.rng.chance(10) {
            return;
        }
        let (history, priority) = (self.history(target), self.priority());
        let (guard, effects) = (self.timed(1), self.effects(scope));
        let edge = format!("{}(In{})", self.rng.pick(&["rise", "fall"]), self.rng.below(self.inputs));
        let to = &self.states[target].name;
        self.put(region, format!("from any to {history}{to}{priority} when {edge} and {guard}{effects}"));
    }

    /// Writes a transition into a region; one that belongs to a parallel state may stand beside them.
    pub fn put(&mut self, region: usize, text: String) {
        self.regions[region].lines.push(Item::line(text));
    }

    pub fn priority(&mut self) -> String {
        if !self.rng.chance(20) {
            return String::new();
        }
        self.priorities.pop().map(|p| format!(" priority {p}")).unwrap_or_default()
    }

    pub fn effects(&mut self, scope: usize) -> String {
        if !self.rng.chance(35) {
            return String::new();
        }
        self.deeds(scope).map(|deeds| format!(" then {deeds}")).unwrap_or_default()
    }

    /// What happens once, if there is something that may be written in the region.
    fn deeds(&mut self, region: usize) -> Option<String> {
        let mut variables = self.regions[region].variables.clone();
        if self.rng.chance(30)
            && let Some(event) = self.request()
        {
            return Some(format!("raise {event}"));
        }
        if self.events > 0 && (variables.is_empty() || self.rng.chance(30)) {
            let raise = format!("raise Ev{}", self.rng.below(self.events));
            let with = if self.rng.chance(30) { self.rng.choose(&variables) } else { None };
            return Some(with.map_or(raise.clone(), |v| format!("{}, {raise}", self.deed(v))));
        }
        if variables.is_empty() {
            return None;
        }
        self.rng.shuffle(&mut variables);
        let count = self.rng.between(1, variables.len().min(2));
        let effects: Vec<String> = variables[..count].iter().map(|&v| self.deed(v)).collect();
        Some(effects.join(", "))
    }

    /// What becomes of a variable or integer.
    pub fn deed(&mut self, variable: usize) -> String {
        let Some(integer) = variable.checked_sub(self.variables) else {
            return format!("{} Var{variable}", self.rng.pick(&["set", "reset"]));
        };
        self.assigned(integer, &(0..self.integers.len()).collect::<Vec<_>>())
    }

    /// What is assigned to an integer, computed from itself or another one of these.
    pub fn assigned(&mut self, integer: usize, others: &[usize]) -> String {
        let value = match self.rng.below(10) {
            0..=4 if !self.is_wide(integer) => {
                let (lowest, highest) = self.integers[integer];
                let most = (highest - lowest).min(3) as usize;
                format!("Int{integer} {} {}", self.rng.pick(&["+", "-"]), self.rng.between(1, most))
            }
            0..=6 => {
                let (lowest, highest) = self.integers[integer];
                (lowest + self.rng.below((highest - lowest + 1) as usize) as i64).to_string()
            }
            // Others may lie far from here.
            _ => {
                let other = *self.rng.pick(others);
                let (a, b) = (self.integers[integer], self.integers[other]);
                if a.1 - a.0 < 20 && b.1 - b.0 < 20 { format!("Int{other}") } else { "0".into() }
            }
        };
        format!("set Int{integer} := {value}")
    }

    /// Whether nothing can be added to the integer, because the sum might be too large for an INT.
    fn is_wide(&self, integer: usize) -> bool {
        let (lowest, highest) = self.integers[integer];
        highest - lowest > 10_000
    }

    /// An integer expression.
    fn sum(&mut self, of: &[usize]) -> String {
        let integer = |model: &mut Model| *model.rng.pick(of);
        let (a, b, n) = (integer(self), integer(self), self.rng.below(2));
        if self.is_wide(a) || self.is_wide(b) {
            return format!("Int{a}");
        }
        let (a, b) = (format!("Int{a}"), format!("Int{b}"));
        match self.rng.below(8) {
            0..=2 => a,
            3 => format!("{a} + {n}"),
            4 => format!("-{a}"),
            5 => format!("{a} - {b}"),
            6 => format!("{n} - ({a} - {b})"),
            _ => format!("{a} + {b} - {n} + -1"),
        }
    }

    /// A comparison that its ranges leave open, mostly.
    pub fn comparison(&mut self) -> String {
        self.comparison_of(&(0..self.integers.len()).collect::<Vec<_>>())
    }

    /// The same of these integers.
    pub fn comparison_of(&mut self, of: &[usize]) -> String {
        let integer = *self.rng.pick(of);
        let (lowest, highest) = self.integers[integer];
        // Neither bound is passed, so each relation depends on the value.
        let value = lowest + 1 + self.rng.below((highest - lowest) as usize) as i64;
        let relation = *self.rng.pick(&["=", "<>", "<", "<=", ">", ">="]);
        match (self.rng.below(10), relation) {
            (0..=1, _) if highest - lowest < 5_000 => format!("{} {relation} {}", self.sum(of), self.sum(of)),
            (_, "<=" | ">") => format!("Int{integer} {relation} {}", value - 1),
            _ => format!("Int{integer} {relation} {value}"),
        }
    }

    /// What states drive, set and reset, what they do when they are entered and left, and what happens
    /// inside them.
    pub fn behaviour(&mut self) {
        for state in 0..self.states.len() {
            if self.states[state].movement {
                continue;
            }
            let region = self.states[state].region;
            let mut lines = Vec::new();
            while self.rng.chance(35) {
                let Some(output) = self.free_output(region) else { break };
                lines.push(format!("drives Out{output}{}", self.condition(45)));
            }
            let mut variables = self.regions[region].variables.clone();
            variables.retain(|&v| v < self.variables);
            while self.rng.chance(25) {
                let Some(variable) = self.rng.choose(&variables) else { break };
                let word = *self.rng.pick(&["sets", "resets"]);
                // What other actions write in the same scan is worth reading.
                let condition = match self.rng.below(4) {
                    0 => format!(" when Var{}", self.rng.below(self.variables)),
                    1 => format!(" when Var{} xor In{}", self.rng.below(self.variables), self.rng.below(self.inputs)),
                    _ => self.condition(70),
                };
                lines.push(format!("{word} Var{variable}{condition}"));
            }
            for word in ["entry", "exit"] {
                if self.rng.chance(15)
                    && let Some(deeds) = self.deeds(region)
                {
                    lines.push(format!("{word} {deeds}"));
                }
            }
            while !self.is_left_at_once(state) && self.rng.chance(15) {
                let Some(deeds) = self.deeds(region) else { break };
                let guard = self.timed(2);
                let edge = format!("{}(In{})", self.rng.pick(&["rise", "fall"]), self.rng.below(self.inputs));
                lines.push(match self.rng.below(3) {
                    0 => format!("internal when {guard} then {deeds}"),
                    _ => format!("internal when {edge} and ({guard}) then {deeds}"),
                });
            }
            self.states[state].lines.extend(lines.into_iter().map(Item::Line));
        }
    }

    /// Whether a transition without a condition leads out of the state, or out of one that holds it.
    fn is_left_at_once(&self, state: usize) -> bool {
        let begins = format!("from {} to ", self.states[state].name);
        let leaves =
            |item: &Item| matches!(item, Item::Line(text) if text.starts_with(&begins) && !text.contains(" when "));
        let lines = self.regions.iter().flat_map(|r| &r.lines).chain(self.states.iter().flat_map(|s| &s.lines));
        let outer = self.regions[self.states[state].region].parent;
        lines.into_iter().any(leaves) || outer.is_some_and(|outer| self.is_left_at_once(outer))
    }

    fn condition(&mut self, percent: usize) -> String {
        if self.rng.chance(percent) { format!(" when {}", self.guard(2)) } else { String::new() }
    }

    /// An output that a state of the region may drive.
    fn free_output(&mut self, region: usize) -> Option<usize> {
        let actuator = self.rng.below(self.actuators.len());
        let a = &self.actuators[actuator];
        match a.technology {
            Technology::Bistable if !self.regions[region].bistable.contains(&actuator) || self.rng.chance(80) => None,
            // Driving both coils would be wrong; one of them may be.
            Technology::Bistable => a.outputs[actuator % 2],
            Technology::Monostable | Technology::OnOff => a.outputs[1],
        }
    }

    /// The guard of a transition, which may wait for some time.
    pub fn timed(&mut self, depth: usize) -> String {
        let (guard, time) = (self.guard(depth), self.rng.between(1, 80));
        match self.rng.below(100) {
            0..=3 => format!("after {time}ms"),
            4..=9 => format!("(after {time}ms and {guard})"),
            10..=13 => format!("(after {time}ms or {guard})"),
            14 => format!("({guard} and not after {time}ms)"),
            15 => format!("({guard} or in({}) xor after {time}ms)", self.states[0].name),
            _ => guard,
        }
    }

    /// A condition, nested at most that deep.
    pub fn guard(&mut self, depth: usize) -> String {
        if depth == 0 || self.rng.chance(60) {
            return self.literal();
        }
        let count = if self.rng.chance(75) { 2 } else { 3 };
        let operands: Vec<String> = (0..count).map(|_| self.guard(depth - 1)).collect();
        match self.rng.below(10) {
            0..=2 => format!("({})", operands.join(" and ")),
            3..=6 => format!("({})", operands.join(" or ")),
            7 => format!("({})", operands[..2].join(" xor ")),
            8 => format!("not {}", operands[0]),
            _ => format!("({} or not {})", operands[0], operands[1]),
        }
    }

    fn literal(&mut self) -> String {
        let input = self.rng.below(self.inputs);
        let text = match self.rng.below(100) {
            0..=34 => format!("In{input}"),
            35..=39 => format!("prev(In{input})"),
            40..=49 => format!("rise(In{input})"),
            50..=55 => format!("fall(In{input})"),
            56..=61 => format!("prev(Out{})", self.rng.below(self.outputs)),
            62..=66 if self.events > 0 => format!("Ev{}", self.rng.below(self.events)),
            67..=75 if !self.integers.is_empty() => self.comparison(),
            62..=75 if self.variables > 0 => format!("Var{}", self.rng.below(self.variables)),
            76..=85 if !self.functions.is_empty() && self.rng.chance(35) => {
                self.of_function().expect("there is a function")
            }
            76..=85 => {
                let observed = if self.rng.chance(40) { self.observed() } else { None };
                let own = self.rng.below(self.states.len());
                format!("in({})", observed.unwrap_or_else(|| self.states[own].name.clone()))
            }
            86..=91 => match (0..self.states.len()).filter(|&s| self.can_be_done(s)).collect::<Vec<_>>()[..] {
                [] => format!("not In{input}"),
                ref done => format!("done({})", self.states[*self.rng.pick(done)].name),
            },
            98 if self.rng.chance(30) => self.rng.pick(&["true", "false"]).to_string(),
            _ => format!("In{input}"),
        };
        if self.rng.chance(25) { format!("not {text}") } else { text }
    }
}
