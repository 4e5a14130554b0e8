//! Models by chance: a seed to the text of a `.chart` file.
//!
//! The generator knows enough of the language's rules that most of what it makes is valid: variables
//! and coils of bistable actuators are dealt out to regions that run side by side, every state has a
//! way in, an output that constraints force both ways is only held or hindered at its edges. It does
//! not know all of them, so that the checks have something to do; what they find is thrown away.
//!
//! Names are unique in the whole text, so that what mentions a thing can be found by its name.

mod behaviour;
mod functions;
mod observers;
mod safety;
mod topology;
mod tree;

use super::items::Item;
use super::rng::Rng;

/// The seeds that a test looks at: so many, unless `CHARTWRIGHT_RANDOM_MODELS` gives another number, or a range such
/// as `500..1000`.
pub fn seeds(usual: u64) -> std::ops::Range<u64> {
    let Ok(wanted) = std::env::var("CHARTWRIGHT_RANDOM_MODELS") else { return 0..usual };
    let (from, to) = wanted.split_once("..").unwrap_or(("0", &wanted));
    let number = |text: &str| text.parse().unwrap_or_else(|_| panic!("CHARTWRIGHT_RANDOM_MODELS={wanted}"));
    number(from)..number(to)
}

/// A model: its items, from which [`items::text`](super::items::text) makes the source.
pub fn model(seed: u64) -> Vec<Item> {
    let mut rng = Rng::new(seed);
    let size = match rng.below(10) {
        0..=1 => rng.between(1, 9),
        2..=7 => rng.between(10, 30),
        _ => rng.between(30, 60),
    };
    let mut model = Model::new(rng, size);
    model.plan_observers();
    model.plan_functions();
    model.tree(size);
    model.transitions();
    model.topology();
    model.behaviour();
    let safety = model.safety();
    let mut items = model.declarations();
    items.extend(model.observer_items());
    items.extend(model.function_items());
    items.extend(model.charts());
    items.extend(safety);
    items
}

/// A range with 0 in it, mostly a small one.
fn range(rng: &mut Rng) -> (i64, i64) {
    let (below, above) = match rng.below(40) {
        0..=24 => (0, rng.between(1, 5)),
        25..=34 => (rng.below(7), rng.between(1, 5)),
        35..=38 => (rng.below(1_000), rng.between(100, 3_000)),
        _ => (32_768, 32_767),
    };
    (-(below as i64), above as i64)
}

/// What an actuator is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Technology {
    Bistable,
    Monostable,
    OnOff,
}

/// An actuator; its outputs are numbers of outputs.
#[derive(Clone, Debug)]
struct Actuator {
    technology: Technology,
    /// The outputs of its two positions.
    outputs: [Option<usize>; 2],
    /// Of the form `by`, which has no sensors.
    short: bool,
}

/// A region.
#[derive(Clone, Debug)]
struct Region {
    /// Its number among those with a name.
    name: Option<usize>,
    parent: Option<usize>,
    actuator: Option<usize>,
    states: Vec<usize>,
    initial: usize,
    /// The variables that may be written in it; numbers from [`Model::variables`] on are integers.
    variables: Vec<usize>,
    /// The bistable actuators that may be driven in it.
    bistable: Vec<usize>,
    /// The choice by which it begins, if it does not begin at its initial state.
    begins: Option<Item>,
    lines: Vec<Item>,
}

/// A state, movements included.
#[derive(Clone, Debug)]
struct State {
    name: String,
    region: usize,
    regions: Vec<usize>,
    is_final: bool,
    /// Index of its position, where its region has an actuator; a movement has none.
    position: Option<usize>,
    movement: bool,
    /// Of a movement, the position to which it leads.
    leads_to: Option<usize>,
    /// How many transitions name it as their source.
    ways_out: usize,
    /// Drives, actions and transitions beside the regions of a parallel state.
    lines: Vec<Item>,
}

/// What becomes a text.
struct Model {
    rng: Rng,
    inputs: usize,
    variables: usize,
    events: usize,
    /// The ranges of integers.
    integers: Vec<(i64, i64)>,
    outputs: usize,
    actuators: Vec<Actuator>,
    regions: Vec<Region>,
    states: Vec<State>,
    observers: Vec<observers::Observer>,
    functions: Vec<functions::Function>,
    /// For each chart its outermost regions.
    charts: Vec<Vec<usize>>,
    /// What names of states begin with.
    prefix: &'static str,
    names: usize,
    priorities: Vec<usize>,
    addresses: bool,
}

/// What is said of the valve of each bistable actuator, in turn.
const VALVES: [&str; 3] = [" valve memory", "", " valve closed-centre"];

impl Model {
    fn new(mut rng: Rng, size: usize) -> Model {
        // Now and then more than fit into a word.
        let inputs = if rng.chance(6) { rng.between(33, 70) } else { rng.between(2, 9) };
        let many = if rng.chance(4) { 36 } else { (1 + size / 6).min(8) };
        let mut actuators = Vec::new();
        let mut outputs = 0;
        for _ in 0..rng.between(1, many) {
            let technology = *rng.pick(&[Technology::Bistable, Technology::Monostable, Technology::OnOff]);
            let mut output = || {
                outputs += 1;
                Some(outputs - 1)
            };
            let (first, second) = match technology {
                Technology::Bistable => (output(), output()),
                Technology::Monostable | Technology::OnOff => (None, output()),
            };
            let short = technology == Technology::OnOff && rng.chance(60);
            actuators.push(Actuator { technology, outputs: [first, second], short });
        }
        let many = if rng.chance(40) { rng.between(1, 3) } else { 0 };
        let integers = (0..many).map(|_| range(&mut rng)).collect();
        let mut priorities: Vec<usize> = (0..400).collect();
        rng.shuffle(&mut priorities);
        Model {
            inputs,
            variables: rng.below(5),
            events: rng.below(3),
            integers,
            outputs,
            actuators,
            regions: Vec::new(),
            states: Vec::new(),
            observers: Vec::new(),
            functions: Vec::new(),
            charts: Vec::new(),
            prefix: rng.pick::<&str>(&["S", "State", "Q", "AnExtraordinarilyLongNameForAState"]),
            names: 0,
            priorities,
            addresses: rng.chance(60),
            rng,
        }
    }

    /// A number that no other name has.
    fn number(&mut self) -> usize {
        self.names += 1;
        self.names
    }

    /// All that stands before the charts.
    fn declarations(&mut self) -> Vec<Item> {
        let at = |area: char, i: usize| format!(" at %{area}X{}.{}", i / 8, i % 8);
        let address = |yes: bool, area: char, i: usize| if yes { at(area, i) } else { String::new() };
        let mut items =
            vec![Item::line("machine Chance"), Item::line(format!("cycle {}ms", self.rng.pick(&[1, 7, 10, 10, 20])))];
        let yes = self.addresses;
        items.push(Item::block(
            "inputs",
            (0..self.inputs).map(|i| Item::line(format!("In{i}{}", address(yes, 'I', i)))),
        ));
        items.push(Item::block(
            "outputs",
            (0..self.outputs).map(|i| Item::line(format!("Out{i}{}", address(yes, 'Q', i)))),
        ));
        if self.variables + self.integers.len() > 0 {
            let mut variables: Vec<Item> = (0..self.variables)
                .map(|i| Item::line(format!("Var{i} : BOOL{}", self.rng.pick(&["", " := true", " := false"]))))
                .collect();
            for (i, &(lowest, highest)) in self.integers.iter().enumerate() {
                let distance = usize::try_from(highest - lowest).expect("the lowest comes first");
                let initial = lowest + self.rng.below(distance + 1) as i64;
                let initial = if self.rng.chance(50) { format!(" := {initial}") } else { String::new() };
                variables.push(Item::line(format!("Int{i} : {lowest}..{highest}{initial}")));
            }
            items.push(Item::block("variables", variables));
        }
        if self.events > 0 {
            items.push(Item::block("events", (0..self.events).map(|i| Item::line(format!("Ev{i}")))));
        }
        for i in 0..self.actuators.len() {
            let Actuator { technology, outputs, short } = self.actuators[i].clone();
            let word = match technology {
                Technology::Bistable => "bistable",
                Technology::Monostable => "monostable",
                Technology::OnOff => "onoff",
            };
            if short {
                let output = outputs[1].expect("the second position has an output");
                items.push(Item::line(format!("actuator Act{i} {word} by Out{output}")));
                continue;
            }
            let mut positions = Vec::new();
            for (p, output) in outputs.into_iter().enumerate() {
                let output = output.map(|o| format!(" output Out{o}")).unwrap_or_default();
                let sensor = if technology == Technology::OnOff { String::new() } else { self.sensor() };
                let limit = self.limit(i, p);
                positions.push(Item::line(format!("position {}{output}{sensor}{limit}", self.position(i, p))));
            }
            let valve = if technology == Technology::Bistable { VALVES[i % VALVES.len()] } else { "" };
            items.push(Item::block(format!("actuator Act{i} {word}{valve}"), positions));
        }
        items
    }

    fn sensor(&mut self) -> String {
        let mut input = || format!("In{}", self.rng.below(self.inputs));
        let (a, b) = (input(), input());
        match self.rng.below(8) {
            0 if a != b => format!(" sensor {a} and not {b}"),
            1 if a != b => format!(" sensor {a} or {b}"),
            2 => format!(" sensor not {a}"),
            _ => format!(" sensor {a}"),
        }
    }

    /// A time limit for movements to a position: if there is one, and what is late may be said there.
    fn limit(&mut self, actuator: usize, position: usize) -> String {
        let movements = self.states.iter().filter(|s| s.movement && self.regions[s.region].actuator == Some(actuator));
        let regions: Vec<usize> = movements.filter(|s| s.leads_to == Some(position)).map(|s| s.region).collect();
        let (Some(&first), true) = (regions.first(), self.rng.chance(50)) else { return String::new() };
        // More than one region may raise an event, but not write a variable.
        let alone = regions.iter().all(|&r| r == first);
        let variables = if alone { self.regions[first].variables.clone() } else { Vec::new() };
        let mut effects: Vec<String> = self.rng.choose(&variables).map(|v| self.deed(v)).into_iter().collect();
        if self.events > 0 && (effects.is_empty() || self.rng.chance(20)) {
            effects.push(format!("raise Ev{}", self.rng.below(self.events)));
        }
        if effects.is_empty() {
            return String::new();
        }
        format!(" within {}ms else {}", self.rng.between(1, 80), effects.join(", "))
    }

    /// The name of a position of an actuator.
    fn position(&self, actuator: usize, position: usize) -> String {
        if self.actuators[actuator].short { ["Off", "On"][position].into() } else { format!("Pos{position}") }
    }
}
