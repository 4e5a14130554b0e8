//! Choices, histories, forks and joins.

use super::super::items::Item;
use super::{Model, Technology};

impl Model {
    /// Some of each, on top of plain transitions.
    pub fn topology(&mut self) {
        for region in 0..self.regions.len() {
            if self.rng.chance(12) {
                self.begins_by_choice(region);
            }
        }
        for _ in 0..self.rng.below(2 + self.states.len() / 6) {
            match self.rng.below(10) {
                0..=2 => self.through_choice(),
                3 => self.lead_back(),
                4..=7 => self.by_history(),
                8 => self.fork(),
                _ => self.join(),
            }
        }
    }

    /// A region that begins where a choice leads.
    fn begins_by_choice(&mut self, region: usize) {
        let states = self.regions[region].states.clone();
        let mut branches = Vec::new();
        for _ in 0..self.rng.between(1, 3) {
            let state = *self.rng.pick(&states);
            branches.push(Item::line(format!("when {} to {}", self.guard(2), self.states[state].name)));
        }
        branches.push(Item::line(format!("else to {}", self.states[self.regions[region].initial].name)));
        let head = format!("initial choice Begin{}", self.number());
        self.regions[region].begins = Some(Item::block(head, branches));
    }

    /// A transition to the choice by which a region begins.
    fn lead_back(&mut self) {
        let region = self.rng.below(self.regions.len());
        let source = *self.rng.pick(&self.regions[region].states);
        let Some(choice) = self.regions[region].begins.as_ref().and_then(|b| b.head().split(' ').next_back()) else {
            return;
        };
        let to = choice.to_owned();
        let (priority, guard, effects) = (self.priority(), self.timed(1), self.effects(region));
        let edge = format!("{}(In{})", self.rng.pick(&["rise", "fall"]), self.rng.below(self.inputs));
        let from = &self.states[source].name;
        self.put(region, format!("from {from} to {to}{priority} when {edge} and {guard}{effects}"));
    }

    /// A transition through one or two choices.
    fn through_choice(&mut self) {
        let source = self.rng.below(self.states.len());
        let region = self.states[source].region;
        let mut next: Option<String> = None;
        for _ in 0..self.rng.between(1, 2) {
            let mut branches = Vec::new();
            for _ in 0..self.rng.between(1, 3) {
                let guard = self.timed(2);
                let Some(way) = self.way(source) else { return };
                branches.push(Item::line(format!("when {guard} to {way}")));
            }
            let last = match next.take() {
                Some(choice) => choice,
                None => match self.way(source) {
                    Some(way) => way,
                    None => return,
                },
            };
            branches.push(Item::line(format!("else to {last}")));
            let name = format!("Choice{}", self.number());
            self.regions[region].lines.push(Item::block(format!("choice {name}"), branches));
            next = Some(name);
        }
        let choice = next.expect("one choice was made");
        let (priority, guard) = (self.priority(), self.timed(1));
        self.put(region, format!("from {} to {choice}{priority} when {guard}", self.states[source].name));
    }

    /// Somewhere to go from a state, with what happens on the way.
    fn way(&mut self, source: usize) -> Option<String> {
        for _ in 0..8 {
            let target = self.rng.below(self.states.len());
            if let Some(scope) = self.scope(source, target).filter(|_| !self.jumps(source, target)) {
                let (history, effects) = (self.history(target), self.effects(scope));
                return Some(format!("{history}{}{effects}", self.states[target].name));
            }
        }
        None
    }

    /// Whether a transition would change the position of a bistable actuator.
    fn jumps(&self, source: usize, target: usize) -> bool {
        let (from, to) = (&self.states[source], &self.states[target]);
        let actuator = self.regions[from.region].actuator.map(|a| self.actuators[a].technology);
        from.region == to.region && actuator == Some(Technology::Bistable) && from.position != to.position
    }

    /// The words for its history, if it has one and chance will have it.
    pub fn history(&mut self, target: usize) -> &'static str {
        if self.states[target].regions.is_empty() || self.rng.chance(40) {
            return "";
        }
        if self.rng.chance(60) { "deep history of " } else { "history of " }
    }

    fn by_history(&mut self) {
        let composite: Vec<usize> = (0..self.states.len()).filter(|&s| !self.states[s].regions.is_empty()).collect();
        let (Some(target), source) = (self.rng.choose(&composite), self.rng.below(self.states.len())) else { return };
        let Some(scope) = self.scope(source, target).filter(|_| !self.jumps(source, target)) else { return };
        let deep = if self.rng.chance(60) { "deep " } else { "" };
        let (priority, guard, effects) = (self.priority(), self.timed(2), self.effects(scope));
        let edge = format!("{}(In{})", self.rng.pick(&["rise", "fall"]), self.rng.below(self.inputs));
        let (from, to) = (&self.states[source].name, &self.states[target].name);
        self.put(scope, format!("from {from} to {deep}history of {to}{priority} when {edge} and {guard}{effects}"));
    }

    /// States in different regions of one parallel state, with that state.
    fn side_by_side(&mut self) -> Option<(usize, String)> {
        let parallel: Vec<usize> = (0..self.states.len()).filter(|&s| self.states[s].regions.len() > 1).collect();
        let parallel = self.rng.choose(&parallel)?;
        let mut regions = self.states[parallel].regions.clone();
        self.rng.shuffle(&mut regions);
        let count = self.rng.between(2, regions.len());
        let inside = |m: &Model, region: usize| -> Vec<usize> {
            let below = |&s: &usize| m.ancestors(s).into_iter().any(|a| m.states[a].region == region);
            (0..m.states.len()).filter(below).collect()
        };
        let names: Vec<String> = regions[..count]
            .iter()
            .map(|&region| {
                let states = inside(self, region);
                self.states[*self.rng.pick(&states)].name.clone()
            })
            .collect();
        Some((parallel, format!("({})", names.join(", "))))
    }

    fn fork(&mut self) {
        let (Some((parallel, names)), source) = (self.side_by_side(), self.rng.below(self.states.len())) else {
            return;
        };
        let Some(scope) = self.scope(source, parallel).filter(|_| !self.jumps(source, parallel)) else { return };
        let (priority, guard, effects) = (self.priority(), self.timed(2), self.effects(scope));
        self.put(scope, format!("from {} to {names}{priority} when {guard}{effects}", self.states[source].name));
    }

    fn join(&mut self) {
        let Some((parallel, names)) = self.side_by_side() else { return };
        let target = self.rng.below(self.states.len());
        let Some(scope) = self.scope(parallel, target).filter(|_| !self.jumps(parallel, target)) else { return };
        let guard = if self.rng.chance(30) { String::new() } else { format!(" when {}", self.timed(1)) };
        let (priority, effects) = (self.priority(), self.effects(scope));
        self.put(scope, format!("from {names} to {}{priority}{guard}{effects}", self.states[target].name));
    }
}
