//! Functions and sequences of them.

use super::super::items::Item;
use super::{Model, Technology};

/// A function on its way to a text.
#[derive(Clone, Debug)]
pub struct Function {
    name: String,
    automatic: bool,
    /// The variables that it may write.
    variables: Vec<usize>,
}

impl Model {
    /// Decides which functions there are, and which variables are theirs.
    pub fn plan_functions(&mut self) {
        let count = if self.rng.chance(75) { 0 } else { self.rng.between(1, 3) };
        for _ in 0..count {
            let name = format!("Fun{}", self.number());
            self.functions.push(Function { name, automatic: self.rng.chance(50), variables: Vec::new() });
        }
        for variable in self.free_variables() {
            if count > 0 && self.rng.chance(20) {
                let at = self.rng.below(count);
                self.functions[at].variables.push(variable);
            }
        }
    }

    /// The variables that functions write.
    pub fn of_functions(&self) -> Vec<usize> {
        self.functions.iter().flat_map(|f| f.variables.iter().copied()).collect()
    }

    /// What can be read of a function, if there is one.
    pub fn of_function(&mut self) -> Option<String> {
        if self.functions.is_empty() {
            return None;
        }
        let Function { name, automatic, .. } = self.rng.pick(&self.functions).clone();
        Some(match self.rng.below(8) {
            0..=2 => format!("in({name}_Running)"),
            3 => format!("in({name}_Off)"),
            4 => format!("{name}_Ended"),
            5 if !automatic => format!("{name}_ds"),
            6 if !automatic => format!("{name}_fs"),
            _ => format!("{name}_Requested"),
        })
    }

    /// An event that asks for a function or for its end, if there is one.
    pub fn request(&mut self) -> Option<String> {
        if self.functions.is_empty() {
            return None;
        }
        let name = self.rng.pick(&self.functions).name.clone();
        Some(format!("{name}_{}", self.rng.pick(&["Activate", "Activate", "Deactivate"])))
    }

    /// The text of all functions, and of sequences of them.
    pub fn function_items(&mut self) -> Vec<Item> {
        let mut items: Vec<Item> = (0..self.functions.len()).map(|i| self.function(i)).collect();
        for _ in 0..if self.functions.is_empty() { 0 } else { self.rng.below(3) } {
            let sequence = self.sequence();
            items.push(sequence);
        }
        items
    }

    fn function(&mut self, index: usize) -> Item {
        // What a function says of itself would mostly be impossible, so it asks for others only.
        let function = self.functions.remove(index);
        let Function { name, automatic, variables } = function.clone();
        let mut lines = Vec::new();
        // Of what nobody asks for nothing can happen.
        for (word, percent) in [("request", 100), ("release", if automatic { 50 } else { 100 })] {
            if self.rng.chance(percent) {
                let condition = self.push();
                lines.push(format!("{word} when {condition}"));
            }
        }
        for (word, percent) in [("activate", 70), ("deactivate", 70), ("abort", 40)] {
            if self.rng.chance(percent) {
                let condition = if word == "deactivate" { self.timed(1) } else { self.guard(1) };
                lines.push(format!("{word} when {condition}"));
            }
        }
        self.rng.shuffle(&mut lines);
        let drives = |actuator: &&super::Actuator| actuator.technology != Technology::Bistable;
        let outputs: Vec<usize> = self.actuators.iter().filter(drives).filter_map(|a| a.outputs[1]).collect();
        if let Some(output) = self.rng.choose(&outputs) {
            lines.push(format!("drives Out{output}"));
        }
        if let Some(variable) = self.rng.choose(&variables) {
            let word = *self.rng.pick(&["sets", "resets", "entry set", "exit reset"]);
            lines.push(format!("{word} Var{variable}"));
        }
        if self.rng.chance(50) {
            let (a, b) = (self.number(), self.number());
            lines.push(format!("initial state {name}_In{a}"));
            lines.push(format!("state {name}_In{b}"));
            for (from, to) in [(a, b), (b, a)] {
                let guard = self.timed(1);
                lines.push(format!("from {name}_In{from} to {name}_In{to} when {guard}"));
            }
        }
        self.functions.insert(index, function);
        let automatic = if automatic { " automatic" } else { "" };
        Item::block(format!("function {name}{automatic}"), lines.into_iter().map(Item::Line))
    }

    /// A condition over inputs.
    fn push(&mut self) -> String {
        let (a, b) = (self.rng.below(self.inputs), self.rng.below(self.inputs));
        match self.rng.below(6) {
            0 => format!("In{a}"),
            1 => format!("fall(In{a})"),
            2 => format!("rise(In{a}) and not In{b}"),
            3 => format!("(prev(In{a}) xor In{b})"),
            _ => format!("rise(In{a})"),
        }
    }

    fn sequence(&mut self) -> Item {
        let mut lines = Vec::new();
        if self.rng.chance(50) {
            let condition = self.guard(1);
            lines.push(format!("abort when {condition}"));
        }
        // What begins anew at once asks for nothing.
        let condition = self.guard(1);
        lines.push(format!("wait until {condition}"));
        for _ in 0..self.rng.between(1, 5) {
            let mut functions: Vec<usize> = (0..self.functions.len()).collect();
            self.rng.shuffle(&mut functions);
            functions.truncate(self.rng.between(1, 2));
            let names: Vec<String> = functions.iter().map(|&f| self.functions[f].name.clone()).collect();
            lines.push(match self.rng.below(10) {
                0..=4 => {
                    let jobs: Vec<String> = functions
                        .iter()
                        .map(|&f| {
                            let Function { name, automatic, .. } = self.functions[f].clone();
                            if automatic { name } else { format!("{name} until {}", self.timed(1)) }
                        })
                        .collect();
                    format!("do {}", jobs.join(", "))
                }
                5..=6 => format!("activate {}", names.join(", ")),
                7 => format!("deactivate {}", names.join(", ")),
                8 => format!("wait {}ms", self.rng.between(1, 80)),
                _ => format!("wait until {}", self.timed(1)),
            });
        }
        Item::block(format!("sequence Seq{}", self.number()), lines.into_iter().map(Item::Line))
    }
}
