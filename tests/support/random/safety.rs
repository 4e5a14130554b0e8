//! Constraints and assumptions.
//!
//! For the filter to have a way out, no output may be forced or relieved both ways at once. So each
//! output is only ever held off, or only ever held on, or both but at its edges: what has not been on
//! may be kept off, what has been on may be kept on.

use super::super::items::{self, Item};
use super::{Model, Technology};

/// Which way constraints may force an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Off,
    On,
    Edge,
}

impl Model {
    /// The safety part, in two of three models.
    pub fn safety(&mut self) -> Option<Item> {
        if self.rng.chance(30) {
            return None;
        }
        if self.rng.chance(12)
            && let Some(items) = self.derived()
        {
            let head = format!("safety {}", self.rng.pick(&["supervisor", "supervisor", "controller"]));
            return Some(Item::block(head, items));
        }
        let mut ways: Vec<Way> =
            (0..self.outputs).map(|_| *self.rng.pick(&[Way::Off, Way::Off, Way::On, Way::Edge])).collect();
        let mut items = Vec::new();
        if self.outputs > 1 && self.rng.chance(15) {
            // Held both ways, but never at once by assumption.
            let output = self.outputs - 1;
            let both = self.readings(" and ");
            let (a, b) = both.split_once(" and ").expect("there are two");
            items.push(Item::line(format!("ConA: never Out{output} and {a}")));
            items.push(Item::line(format!("ConB: never not Out{output} and {b}")));
            items.push(Item::line(format!("assume AssA: never {both}")));
            ways.pop();
        }
        for i in 0..self.rng.between(1, 9) {
            let text = if ways.len() > 1 && self.rng.chance(55) { self.combined(&ways) } else { self.simple(&ways) };
            items.push(Item::line(format!("Con{i}: never {text}")));
        }
        // One relief that sets off another one.
        let off: Vec<usize> = (0..ways.len()).filter(|&o| ways[o] == Way::Off).collect();
        if let ([a, b, c, ..], true) = (&off[..], self.rng.chance(60)) {
            items.push(Item::line(format!("ConC: never Out{a} and Out{b} yields Out{b}")));
            items.push(Item::line(format!("ConD: never not Out{b} and Out{c} yields Out{c}")));
        }
        while self.rng.chance(20) {
            let number = self.number();
            let readings = self.readings(" and ");
            items.push(Item::line(format!("assume Ass{number}: never {readings}")));
        }
        let order = if self.rng.chance(30) { " relief in-order" } else { "" };
        let reset = format!("{order} reset by In{}", self.rng.below(self.inputs));
        let head = match self.rng.below(10) {
            0..=3 => format!("safety supervisor{order}"),
            4..=5 => format!("safety supervisor{reset}"),
            6 => format!("safety controller{order}"),
            _ => format!("safety blocking{reset}"),
        };
        Some(Item::block(head, items))
    }

    /// What actuators and forbidden positions demand, if there is an actuator that demands something.
    fn derived(&mut self) -> Option<Vec<Item>> {
        let is = |i: &usize, technology| self.actuators[*i].technology == technology;
        let all = 0..self.actuators.len();
        if !all.clone().any(|i| is(&i, Technology::Bistable)) {
            return None;
        }
        // Those whose valve is declared, and those with a spring.
        let told = |i: &usize| is(i, Technology::Bistable) && i % 3 != 1 || is(i, Technology::Monostable);
        let told: Vec<usize> = all.filter(told).collect();
        let mut items = Vec::new();
        if let [.., a, b] = told[..] {
            let [a, b] = [a, b].map(|i| match self.rng.below(3) {
                1 => format!("Act{i} between"),
                p => format!("Act{i} at {}", self.position(i, p / 2)),
            });
            items.push(Item::line(format!("For: forbid {a} {} {b}", self.rng.pick(&["and", "unless"]))));
        }
        items.push(Item::line(format!("derive all{}", self.rng.pick(&["", " by edges"]))));
        Some(items)
    }

    /// A literal of an output that a constraint may make FALSE; now and then one that it may not.
    fn yielding(&mut self, ways: &[Way], output: usize) -> String {
        let way = if self.rng.chance(1) { Way::Off } else { ways[output] };
        match (way, self.rng.below(4)) {
            (Way::Off, 0) => format!("rise(Out{output})"),
            (Way::Off, _) => format!("Out{output}"),
            (Way::On, 0) => format!("fall(Out{output})"),
            (Way::On, _) => format!("not Out{output}"),
            (Way::Edge, 0..=1) => format!("rise(Out{output})"),
            (Way::Edge, _) => format!("fall(Out{output})"),
        }
    }

    fn simple(&mut self, ways: &[Way]) -> String {
        let output = self.rng.below(ways.len());
        let literal = self.yielding(ways, output);
        match self.rng.below(20) {
            0 => literal,
            1..=10 => format!("{literal} and {}", self.reading()),
            11..=14 => format!("{literal} and {}", self.readings(" and ")),
            15..=17 => format!("{literal} and ({})", self.readings(" or ")),
            _ => format!("{literal} and ({})", self.readings(" xor ")),
        }
    }

    fn combined(&mut self, ways: &[Way]) -> String {
        let mut outputs: Vec<usize> = (0..ways.len()).collect();
        self.rng.shuffle(&mut outputs);
        outputs.truncate(self.rng.between(2, 4.min(ways.len())));
        let first = self.yielding(ways, outputs[0]);
        let mut yields = vec![outputs[0]];
        let mut others = Vec::new();
        for &output in &outputs[1..] {
            if self.rng.chance(20) {
                others.push(self.yielding(ways, output));
                yields.push(output);
            } else {
                let form = *self.rng.pick(&["Out", "Out", "not Out", "not Out", "rise", "fall"]);
                others.push(match form {
                    "rise" | "fall" => format!("{form}(Out{output})"),
                    _ => format!("{form}{output}"),
                });
            }
        }
        let mut text = match others.as_slice() {
            [a, b, ..] if yields.len() == 1 && self.rng.chance(30) => {
                format!("{first} and ({a} {} {b})", self.rng.pick(&["or", "xor"]))
            }
            _ => {
                others.push(first);
                self.rng.shuffle(&mut others);
                others.join(" and ")
            }
        };
        match self.rng.below(10) {
            0..=5 => {}
            6..=8 => text = format!("{text} and {}", self.reading()),
            _ => text = format!("{text} and {}", self.readings(" and ")),
        }
        let yields: Vec<String> = yields.into_iter().map(|o| format!("Out{o}")).collect();
        format!("{text} yields {}", yields.join(", "))
    }

    /// Two literals of different things.
    fn readings(&mut self, operator: &str) -> String {
        let a = self.reading();
        loop {
            let b = self.reading();
            let of_a = items::words(&a);
            if !items::words(&b).iter().any(|w| of_a.contains(w) && w.ends_with(|c: char| c.is_ascii_digit())) {
                return format!("{a}{operator}{b}");
            }
        }
    }

    /// A literal that constraints read but do not decide.
    fn reading(&mut self) -> String {
        let input = self.rng.below(self.inputs);
        let text = match self.rng.below(20) {
            0..=9 => format!("In{input}"),
            10..=11 => format!("prev(In{input})"),
            12..=14 => return format!("{}(In{input})", self.rng.pick(&["rise", "fall"])),
            15..=16 => format!("prev(Out{})", self.rng.below(self.outputs)),
            17..=18 if !self.observers.is_empty() => {
                let state = self.observed().expect("there is an observer");
                return format!("{}in({state})", self.rng.pick(&["", "not "]));
            }
            19 if self.events > 0 => format!("Ev{}", self.rng.below(self.events)),
            _ if !self.integers.is_empty() && self.rng.chance(50) => self.comparison(),
            _ if self.variables > 0 => format!("Var{}", self.rng.below(self.variables)),
            _ => format!("In{input}"),
        };
        if self.rng.chance(35) { format!("not {text}") } else { text }
    }
}
