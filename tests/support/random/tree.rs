//! The hierarchy: charts, regions and states, and their text.

use super::super::items::Item;
use super::{Model, Region, State, Technology};

/// How deep states may lie in each other.
const DEPTH: usize = 6;

impl Model {
    /// Makes charts with about that many states.
    pub fn tree(&mut self, size: usize) {
        let charts = if size > 3 && self.rng.chance(30) { self.rng.between(2, 3) } else { 1 };
        let shares = self.rng.split(size, charts);
        let mut free = self.free_variables();
        free.extend(self.free_integers());
        let variables = self.deal(&free, charts);
        let bistable = (0..self.actuators.len()).filter(|&a| self.actuators[a].technology == Technology::Bistable);
        let bistable = self.deal(&bistable.collect::<Vec<_>>(), charts);
        for (chart, share) in shares.into_iter().enumerate() {
            self.charts.push(Vec::new());
            let parallel = share > 2 && self.rng.chance(20);
            let regions = self.regions(None, share.max(1), 0, (&variables[chart], &bistable[chart]), parallel);
            self.charts[chart] = regions;
        }
    }

    /// Deals `items` out to that many who run side by side.
    fn deal(&mut self, items: &[usize], hands: usize) -> Vec<Vec<usize>> {
        let mut dealt = vec![Vec::new(); hands];
        for &item in items {
            dealt[self.rng.below(hands)].push(item);
        }
        dealt
    }

    fn regions(
        &mut self,
        parent: Option<usize>,
        size: usize,
        depth: usize,
        (variables, bistable): (&[usize], &[usize]),
        parallel: bool,
    ) -> Vec<usize> {
        if !parallel {
            return vec![self.region(parent, None, size, depth, (variables, bistable))];
        }
        let count = self.rng.between(2, 4.min(size.max(2)));
        let shares = self.rng.split(size, count);
        // Some variables stay with what contains the regions.
        let kept: Vec<usize> = variables.iter().copied().filter(|_| !self.rng.chance(20)).collect();
        let (variables, bistable) = (self.deal(&kept, count), self.deal(bistable, count));
        (0..count)
            .map(|i| {
                let name = Some(self.number());
                self.region(parent, name, shares[i].max(1), depth, (&variables[i], &bistable[i]))
            })
            .collect()
    }

    fn region(
        &mut self,
        parent: Option<usize>,
        name: Option<usize>,
        size: usize,
        depth: usize,
        (variables, bistable): (&[usize], &[usize]),
    ) -> usize {
        let free = |&a: &usize| self.actuators[a].technology != Technology::Bistable || bistable.contains(&a);
        let candidates: Vec<usize> = (0..self.actuators.len()).filter(free).collect();
        let actuator = if self.rng.chance(40) { self.rng.choose(&candidates) } else { None };
        let id = self.regions.len();
        self.regions.push(Region {
            name,
            parent,
            actuator,
            states: Vec::new(),
            initial: 0,
            variables: variables.to_vec(),
            bistable: bistable.to_vec(),
            begins: None,
            lines: Vec::new(),
        });
        let count = self.rng.between(1, 6.min(size)).max(2.min(size));
        let mut inside = vec![0; count];
        if depth + 1 < DEPTH && size > count {
            // Few states get all the rest, so that it goes deep.
            let composite = self.rng.between(1, 3.min(count));
            for (i, share) in self.rng.split(size - count, composite).into_iter().enumerate() {
                inside[i] = share;
            }
            self.rng.shuffle(&mut inside);
        }
        for share in inside {
            let number = self.number();
            let state = self.states.len();
            self.states.push(State {
                name: format!("{}{number}", self.prefix),
                region: id,
                regions: Vec::new(),
                is_final: share == 0 && self.rng.chance(25),
                position: actuator.map(|_| self.rng.below(2)),
                movement: false,
                leads_to: None,
                ways_out: 0,
                lines: Vec::new(),
            });
            self.regions[id].states.push(state);
            if share > 0 {
                let parallel = share > 1 && self.rng.chance(45);
                let inner = self.regions(Some(state), share, depth + 1, (variables, bistable), parallel);
                self.states[state].regions = inner;
            }
        }
        let states = self.regions[id].states.clone();
        self.regions[id].initial = *self.rng.pick(&states);
        if self.rng.chance(80) {
            let initial = self.regions[id].initial;
            self.states[initial].is_final = false;
        }
        id
    }

    /// The states that contain `state`, itself first.
    pub fn ancestors(&self, state: usize) -> Vec<usize> {
        std::iter::successors(Some(state), |&s| self.regions[self.states[s].region].parent).collect()
    }

    /// The innermost region that contains both states.
    pub fn scope(&self, a: usize, b: usize) -> Option<usize> {
        let of_b: Vec<usize> = self.ancestors(b).into_iter().map(|s| self.states[s].region).collect();
        self.ancestors(a).into_iter().map(|s| self.states[s].region).find(|r| of_b.contains(r))
    }

    /// Whether each region of the state has a final state.
    pub fn can_be_done(&self, state: usize) -> bool {
        let regions = &self.states[state].regions;
        !regions.is_empty() && regions.iter().all(|&r| self.regions[r].states.iter().any(|&s| self.states[s].is_final))
    }

    /// The text of all charts.
    pub fn charts(&mut self) -> Vec<Item> {
        (0..self.charts.len())
            .map(|chart| {
                let regions = self.charts[chart].clone();
                let (controls, mut items) = self.bodies(&regions);
                self.mix(&mut items, Vec::new());
                Item::block(format!("chart Chart{chart}{controls}"), items)
            })
            .collect()
    }

    /// What an owner of regions controls, and what stands between its braces.
    fn bodies(&mut self, regions: &[usize]) -> (String, Vec<Item>) {
        if let [only] = regions
            && self.regions[*only].name.is_none()
        {
            return (self.controls(*only), self.body(*only));
        }
        let items = regions.iter().map(|&r| {
            let name = self.regions[r].name.expect("one of several regions has a name");
            Item::block(format!("region R{name}{}", self.controls(r)), self.body(r))
        });
        (String::new(), items.collect())
    }

    fn controls(&self, region: usize) -> String {
        self.regions[region].actuator.map(|a| format!(" controls Act{a}")).unwrap_or_default()
    }

    fn body(&mut self, region: usize) -> Vec<Item> {
        let Region { states, initial, actuator, begins, lines, .. } = self.regions[region].clone();
        let begins_here = |state| begins.is_none() && state == initial;
        let mut items: Vec<Item> = begins.iter().cloned().collect();
        for state in states {
            if self.states[state].movement {
                continue;
            }
            let State { name, regions, is_final, position, lines, .. } = self.states[state].clone();
            let mut head = String::new();
            if begins_here(state) {
                head.push_str("initial ");
            }
            if is_final {
                head.push_str("final ");
            }
            if regions.len() > 1 {
                head.push_str("parallel ");
            }
            head.push_str(&format!("state {name}"));
            if let (Some(position), Some(actuator)) = (position, actuator) {
                head.push_str(&format!(" at {}", self.position(actuator, position)));
            }
            if regions.is_empty() && lines.is_empty() {
                items.push(Item::line(head));
            } else if regions.is_empty() {
                items.push(Item::block(head, lines));
            } else {
                let (controls, mut inner) = self.bodies(&regions);
                self.mix(&mut inner, lines);
                items.push(Item::block(head + &controls, inner));
            }
        }
        self.mix(&mut items, lines);
        items
    }

    /// Puts more items before or after those that are there.
    fn mix(&mut self, items: &mut Vec<Item>, more: Vec<Item>) {
        let at = if self.rng.chance(50) { 0 } else { items.len() };
        items.splice(at..at, more);
    }
}
