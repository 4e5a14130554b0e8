//! Observers: flat ones, most of which also move after the filter, and some with a state inside.

use super::super::items::Item;
use super::Model;

/// An observer on its way to a text.
#[derive(Clone, Debug)]
pub struct Observer {
    /// The states of its outermost region; the first one is initial.
    states: Vec<String>,
    /// The states inside the second one; the last one is final.
    inside: Vec<String>,
    /// The variables that it may write; numbers from [`Model::variables`] on are integers.
    variables: Vec<usize>,
    /// Whether it has a part after the filter.
    twice: bool,
}

impl Model {
    /// Decides which observers there are, and which variables are theirs.
    pub fn plan_observers(&mut self) {
        let count = if self.rng.chance(45) { 0 } else { self.rng.between(1, 3) };
        for _ in 0..count {
            let mut name = |_| format!("Obs{}", self.number());
            let states: Vec<String> = (0..4).map(&mut name).collect();
            let inside: Vec<String> = (0..2).map(&mut name).collect();
            let shape = self.rng.below(4);
            let count = self.rng.between(2, 4);
            let observer = Observer {
                states: states.into_iter().take(count).collect(),
                inside: if shape == 0 { inside } else { Vec::new() },
                variables: Vec::new(),
                twice: shape > 1,
            };
            self.observers.push(observer);
        }
        for variable in 0..self.variables + self.integers.len() {
            if !self.observers.is_empty() && self.rng.chance(40) {
                let at = self.rng.below(self.observers.len());
                self.observers[at].variables.push(variable);
            }
        }
    }

    /// The variables that neither observers nor functions write.
    pub fn free_variables(&self) -> Vec<usize> {
        let taken = [self.remembered(), self.of_functions()].concat();
        (0..self.variables).filter(|v| !taken.contains(v)).collect()
    }

    /// The integers that no observer counts, as numbers of variables.
    pub fn free_integers(&self) -> Vec<usize> {
        let taken = self.remembered();
        (self.variables..self.variables + self.integers.len()).filter(|v| !taken.contains(v)).collect()
    }

    /// A state of an observer, if there is one.
    pub fn observed(&mut self) -> Option<String> {
        let all: Vec<&String> = self.observers.iter().flat_map(|o| o.states.iter().chain(&o.inside)).collect();
        self.rng.choose(&all).cloned()
    }

    /// The text of all observers.
    pub fn observer_items(&mut self) -> Vec<Item> {
        (0..self.observers.len()).map(|i| self.observer(i)).collect()
    }

    fn remembered(&self) -> Vec<usize> {
        self.observers.iter().flat_map(|o| o.variables.iter().copied()).collect()
    }

    fn observer(&mut self, index: usize) -> Item {
        let Observer { states, inside, variables, twice } = self.observers[index].clone();
        let mut items: Vec<Item> = Vec::new();
        for (i, state) in states.iter().enumerate() {
            let head = format!("{}state {state}", if i == 0 { "initial " } else { "" });
            let does = self.once(&variables, !twice);
            items.push(if does.is_empty() { Item::line(head) } else { Item::block(head, does) });
        }
        if let [first, last] = &inside[..] {
            let guard = self.observation(1, false, true);
            let lines = [
                format!("initial state {first}"),
                format!("final state {last}"),
                format!("from {first} to {last} when {guard}"),
            ];
            let does = self.once(&variables, true);
            items[1] = Item::block(format!("state {}", states[1]), lines.map(Item::line).into_iter().chain(does));
        }
        let mut lines = [Vec::new(), Vec::new()];
        // A way into every state, and some more.
        let mut ways: Vec<(String, String)> = (1..states.len())
            .map(|to| (states[self.rng.below(to)].clone(), states[to].clone()))
            .chain([(states[states.len() - 1].clone(), states[0].clone())])
            .collect();
        while self.rng.chance(60) {
            let all: Vec<&String> = states.iter().chain(&inside).collect();
            ways.push((self.rng.pick(&all).to_string(), self.rng.pick(&all).to_string()));
        }
        for (from, to) in ways {
            let end = twice && self.rng.chance(50);
            let guard = match self.rng.below(6) {
                0 if from == states[1] && !inside.is_empty() => "done".to_owned(),
                _ => self.observation(2, end, !twice),
            };
            let priority = self.priority();
            let effects = match self.noted(&variables) {
                Some(deed) if self.rng.chance(60) => format!(" then {deed}"),
                _ => String::new(),
            };
            lines[usize::from(end)].push(Item::line(format!("from {from} to {to}{priority} when {guard}{effects}")));
        }
        if !twice && self.rng.chance(40) {
            let choice = format!("Fork{}", self.number());
            let guard = self.observation(2, false, true);
            let (a, b) = (self.rng.pick(&states).clone(), self.rng.pick(&states).clone());
            let branches = [format!("when {guard} to {a}"), format!("else to {b}")];
            let (from, when) = (self.rng.pick(&states).clone(), self.observation(1, false, true));
            lines[0].push(Item::line(format!("from {from} to {choice} when {when}")));
            items.push(Item::block(format!("choice {choice}"), branches.map(Item::line)));
        }
        if !inside.is_empty() && self.rng.chance(50) {
            let (deep, guard) = (*self.rng.pick(&["", "deep "]), self.observation(1, false, true));
            lines[0].push(Item::line(format!("from {} to {deep}history of {} when {guard}", states[0], states[1])));
        }
        let [start, end] = lines;
        items.extend(start);
        if !twice && self.rng.chance(30) {
            let (region, other, a, b) = (self.number(), self.number(), self.number(), self.number());
            let [there, back] = [0, 1].map(|_| self.observation(2, false, true));
            let beside = [
                format!("initial state Obs{a}"),
                format!("state Obs{b}"),
                format!("from Obs{a} to Obs{b} when {there}"),
                format!("from Obs{b} to Obs{a} when {back}"),
            ];
            items = vec![
                Item::block(format!("region R{region}"), items),
                Item::block(format!("region R{other}"), beside.map(Item::line)),
            ];
        }
        if !end.is_empty() {
            items.push(Item::block("after filter", end));
        }
        Item::block(format!("observer Watch{index}"), items)
    }

    /// What an observer writes once, into one of these variables or integers: what is assigned is computed
    /// from its own.
    fn noted(&mut self, variables: &[usize]) -> Option<String> {
        let variable = self.rng.choose(variables)?;
        let Some(integer) = variable.checked_sub(self.variables) else { return Some(self.deed(variable)) };
        let own: Vec<usize> = variables.iter().filter_map(|v| v.checked_sub(self.variables)).collect();
        Some(self.assigned(integer, &own))
    }

    /// What a state of an observer does when it is entered and left, and what happens inside it.
    fn once(&mut self, variables: &[usize], times: bool) -> Vec<Item> {
        let mut lines = Vec::new();
        for word in ["entry", "exit"] {
            if self.rng.chance(25)
                && let Some(deed) = self.noted(variables)
            {
                lines.push(Item::line(format!("{word} {deed}")));
            }
        }
        if self.rng.chance(20)
            && let Some(deed) = self.noted(variables)
        {
            let guard = self.observation(1, false, times);
            lines.push(Item::line(format!("internal when {guard} then {deed}")));
        }
        lines
    }

    /// What an observer may ask for; outputs of this scan only after the filter, times only if it has no
    /// part there.
    fn observation(&mut self, depth: usize, end: bool, times: bool) -> String {
        if depth > 0 && self.rng.chance(45) {
            let operands = [0, 1].map(|_| self.observation(depth - 1, end, times));
            return format!("({})", operands.join(self.rng.pick::<&str>(&[" and ", " or ", " xor "])));
        }
        let (input, output) = (self.rng.below(self.inputs), self.rng.below(self.outputs));
        let remembered = self.remembered();
        let text = match self.rng.below(20) {
            0..=1 => format!("rise(In{input})"),
            2 => format!("fall(In{input})"),
            3 => format!("prev(In{input})"),
            4..=5 => format!("prev(Out{output})"),
            6..=9 if end => format!("{}(Out{output})", self.rng.pick(&["rise", "rise", "fall"])),
            10..=11 if end => format!("Out{output}"),
            12..=14 => format!("in({})", self.observed().expect("there is an observer")),
            15 if times => format!("after {}ms", self.rng.between(1, 80)),
            16..=18 if !remembered.is_empty() => match *self.rng.pick(&remembered) {
                v if v < self.variables => format!("Var{v}"),
                _ => {
                    let counted = remembered.iter().filter_map(|v| v.checked_sub(self.variables)).collect::<Vec<_>>();
                    self.comparison_of(&counted)
                }
            },
            _ => format!("In{input}"),
        };
        if self.rng.chance(25) { format!("not {text}") } else { text }
    }
}
