//! What states and regions are called: by a path, which no other state or region of the machine has.

use super::{Machine, RegionId, StateId};

impl Machine {
    /// The name of a state with those of all that contains it, from the outside in:
    /// `InProduction.Automatic.Preparation.V.Down`. The name of the chart stands before it only where the
    /// rest could be something of another chart, too.
    pub fn state_path(&self, state: StateId) -> String {
        self.told_apart(self.regions[self.states[state].region].chart, self.words(state))
    }

    /// The name of a region in the same way; that of its state or chart where it has none.
    pub fn region_path(&self, region: RegionId) -> String {
        let r = &self.regions[region];
        let mut words = r.parent.map_or(Vec::new(), |p| self.words(p));
        words.extend(r.name.as_deref());
        if words.is_empty() { self.charts[r.chart].name.clone() } else { self.told_apart(r.chart, words) }
    }

    /// The words of a state's path within its chart.
    fn words(&self, state: StateId) -> Vec<&str> {
        let mut words = Vec::new();
        for s in self.ancestors(state) {
            words.push(self.states[s].name.as_str());
            words.extend(self.regions[self.states[s].region].name.as_deref());
        }
        words.reverse();
        words
    }

    /// The path of something in a chart, behind the chart's name where that is needed: if another chart has
    /// the same path, or if it reads like such a path with the name of its chart.
    fn told_apart(&self, chart: usize, words: Vec<&str>) -> String {
        let elsewhere = (0..self.charts.len()).any(|c| c != chart && self.leads_somewhere(c, &words));
        let named = |c: usize| same(&self.charts[c].name, words[0]) && self.leads_somewhere(c, &words[1..]);
        let path = words.join(".");
        if elsewhere || (0..self.charts.len()).any(named) {
            format!("{}.{path}", self.charts[chart].name)
        } else {
            path
        }
    }

    /// Whether the words lead to a state or region of the chart.
    fn leads_somewhere(&self, chart: usize, words: &[&str]) -> bool {
        !words.is_empty() && self.among(&self.charts[chart].regions, words)
    }

    /// Whether they lead to one of these regions or into it. Recursion is bounded by the nesting limit.
    fn among(&self, regions: &[RegionId], words: &[&str]) -> bool {
        regions.iter().any(|&r| match &self.regions[r].name {
            Some(name) => same(name, words[0]) && (words.len() == 1 || self.within(r, &words[1..])),
            None => self.within(r, words),
        })
    }

    /// Whether they lead to a state of the region or into one.
    fn within(&self, region: RegionId, words: &[&str]) -> bool {
        self.regions[region]
            .states
            .iter()
            .map(|&s| &self.states[s])
            .any(|state| same(&state.name, words[0]) && (words.len() == 1 || self.among(&state.regions, &words[1..])))
    }
}

/// Whether two names are the same in a PLC.
fn same(a: &str, b: &str) -> bool {
    a.eq_ignore_ascii_case(b)
}
