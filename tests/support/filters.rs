//! Sets of constraints in a plain form, which knows nothing of the compiler: what the filter should do, tried
//! case by case.

use super::rng::Rng;

/// Something that constraints read and do not decide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// An input.
    Input(usize),
    /// An output in the scan before.
    Was(usize),
}

/// What must never be TRUE: all outputs, plain or negated, and all readings.
#[derive(Clone, Debug)]
pub struct Product {
    pub outputs: Vec<(usize, bool)>,
    pub readings: Vec<(Reading, bool)>,
    pub yields: Vec<usize>,
}

/// A set of constraints.
#[derive(Clone, Debug)]
pub struct Set {
    pub inputs: usize,
    pub outputs: usize,
    pub in_order: bool,
    pub products: Vec<Product>,
    pub assumptions: Vec<Vec<(Reading, bool)>>,
}

/// What constraints read in one scan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Case {
    pub inputs: Vec<bool>,
    pub was: Vec<bool>,
}

impl Case {
    fn is(&self, readings: &[(Reading, bool)]) -> bool {
        readings.iter().all(|&(reading, negated)| {
            negated
                != match reading {
                    Reading::Input(i) => self.inputs[i],
                    Reading::Was(o) => self.was[o],
                }
        })
    }
}

/// How a filter ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// With these outputs, which violate nothing, after so many evaluations in vain.
    Safe(Vec<bool>, usize),
    /// Something is violated and always will be.
    Stuck,
}

impl Set {
    /// A set by chance, small enough to be tried case by case.
    pub fn random(seed: u64) -> Set {
        let mut rng = Rng::new(seed ^ 0x0066_696c_7465_7273);
        let (inputs, outputs) = (rng.between(1, 3), rng.between(2, 4));
        let mut set = Set { inputs, outputs, in_order: rng.chance(40), products: Vec::new(), assumptions: Vec::new() };
        // Where outputs only ever go off, most sets are coherent; where anything goes, few are.
        let bold = rng.chance(50);
        for _ in 0..rng.between(1, 7) {
            let mut chosen: Vec<usize> = (0..outputs).collect();
            rng.shuffle(&mut chosen);
            chosen.truncate(if rng.chance(35) { 1 } else { rng.between(2, 3.min(outputs)) });
            let negated: Vec<bool> = chosen.iter().map(|_| rng.chance(if bold { 45 } else { 20 })).collect();
            let outputs: Vec<(usize, bool)> = chosen.into_iter().zip(negated).collect();
            let mut yields = Vec::new();
            if outputs.len() > 1 {
                let mut able: Vec<usize> =
                    outputs.iter().filter(|(_, negated)| bold || !negated).map(|(o, _)| *o).collect();
                if able.is_empty() {
                    able.push(outputs[0].0);
                }
                yields.push(*rng.pick(&able));
                yields.extend(able.iter().copied().filter(|o| *o != yields[0] && rng.chance(15)).collect::<Vec<_>>());
            }
            let readings = set.readings(&mut rng, 2);
            set.products.push(Product { outputs, readings, yields });
        }
        while rng.chance(25) {
            let readings = set.readings(&mut rng, 2);
            if !readings.is_empty() {
                set.assumptions.push(readings);
            }
        }
        set
    }

    fn readings(&self, rng: &mut Rng, most: usize) -> Vec<(Reading, bool)> {
        let mut readings: Vec<(Reading, bool)> = Vec::new();
        for _ in 0..rng.below(most + 1) {
            let reading = if rng.chance(70) {
                Reading::Input(rng.below(self.inputs))
            } else {
                Reading::Was(rng.below(self.outputs))
            };
            if readings.iter().all(|(r, _)| *r != reading) {
                readings.push((reading, rng.chance(40)));
            }
        }
        readings
    }

    /// A machine in which the input `Ck` commands the output `Ok`.
    pub fn source(&self) -> String {
        let literal = |name: String, negated: bool| if negated { format!("not {name}") } else { name };
        let reading = |r: &(Reading, bool)| match *r {
            (Reading::Input(i), negated) => literal(format!("X{i}"), negated),
            (Reading::Was(o), negated) => literal(format!("prev(Y{o})"), negated),
        };
        let mut text = "machine Chance\ninputs {".to_owned();
        (0..self.inputs).for_each(|i| text += &format!(" X{i}"));
        (0..self.outputs).for_each(|o| text += &format!(" C{o}"));
        text += " }\noutputs {";
        (0..self.outputs).for_each(|o| text += &format!(" Y{o}"));
        text += " }\n";
        (0..self.outputs).for_each(|o| text += &format!("actuator A{o} onoff by Y{o}\n"));
        text += "chart Chance { initial state On {";
        (0..self.outputs).for_each(|o| text += &format!(" drives Y{o} when C{o}"));
        text += " } }\nsafety supervisor";
        text += if self.in_order { " relief in-order {\n" } else { " {\n" };
        for (i, p) in self.products.iter().enumerate() {
            let outputs = p.outputs.iter().map(|&(o, negated)| literal(format!("Y{o}"), negated));
            let literals: Vec<String> = outputs.chain(p.readings.iter().map(reading)).collect();
            let yields: Vec<String> = p.yields.iter().map(|o| format!("Y{o}")).collect();
            let yields = if yields.is_empty() { String::new() } else { format!(" yields {}", yields.join(", ")) };
            text += &format!("  S{i}: never {}{yields}\n", literals.join(" and "));
        }
        for (i, readings) in self.assumptions.iter().enumerate() {
            let literals: Vec<String> = readings.iter().map(reading).collect();
            text += &format!("  assume P{i}: never {}\n", literals.join(" and "));
        }
        text + "}\n"
    }

    /// Every case that no assumption excludes.
    pub fn cases(&self) -> Vec<Case> {
        let bits = self.inputs + self.outputs;
        let case = |code: usize| Case {
            inputs: (0..self.inputs).map(|i| code >> i & 1 == 1).collect(),
            was: (0..self.outputs).map(|o| code >> (self.inputs + o) & 1 == 1).collect(),
        };
        (0..1 << bits).map(case).filter(|c| self.assumed(c)).collect()
    }

    /// Whether the case breaks no assumption.
    pub fn assumed(&self, case: &Case) -> bool {
        self.assumptions.iter().all(|a| !case.is(a))
    }

    /// Every assignment of the outputs.
    pub fn vectors(&self) -> Vec<Vec<bool>> {
        (0..1usize << self.outputs).map(|code| (0..self.outputs).map(|o| code >> o & 1 == 1).collect()).collect()
    }

    fn holds(&self, product: &Product, case: &Case, outputs: &[bool]) -> bool {
        product.outputs.iter().all(|&(o, negated)| outputs[o] != negated) && case.is(&product.readings)
    }

    /// Whether the outputs violate nothing.
    pub fn safe(&self, case: &Case, outputs: &[bool]) -> bool {
        self.products.iter().all(|p| !self.holds(p, case, outputs))
    }

    fn combined(&self) -> impl Iterator<Item = &Product> {
        self.products.iter().filter(|p| p.outputs.len() > 1)
    }

    /// What simple products force off and on: fs0 and fs1.
    fn forced(&self, case: &Case) -> Vec<[bool; 2]> {
        let mut forced = vec![[false; 2]; self.outputs];
        for p in self.products.iter().filter(|p| p.outputs.len() == 1 && case.is(&p.readings)) {
            let (o, negated) = p.outputs[0];
            forced[o][usize::from(negated)] = true;
        }
        forced
    }

    fn select(forced: &[[bool; 2]], relieved: &[[bool; 2]], commands: &[bool]) -> Vec<bool> {
        let each = forced.iter().zip(relieved).zip(commands);
        each.map(|(([fs0, fs1], [fc0, fc1]), g1)| !fs0 && (!fc0 && *g1 || *fc1) || *fs1).collect()
    }

    fn relieve(&self, product: &Product, relieved: &mut [[bool; 2]]) {
        for &(o, negated) in product.outputs.iter().filter(|(o, _)| product.yields.contains(o)) {
            relieved[o][usize::from(negated)] = true;
        }
    }

    /// What the filter of the language should make of the commands.
    pub fn filter(&self, case: &Case, commands: &[bool]) -> End {
        if self.in_order { self.sweeps(case, commands) } else { self.corrected(case, commands) }
    }

    /// The corrected algorithm: forcings accumulate.
    fn corrected(&self, case: &Case, commands: &[bool]) -> End {
        let forced = self.forced(case);
        let mut relieved = vec![[false; 2]; self.outputs];
        for round in 0.. {
            let outputs = Self::select(&forced, &relieved, commands);
            if self.safe(case, &outputs) {
                return End::Safe(outputs, round);
            }
            let before = relieved.clone();
            for p in self.combined().filter(|p| self.holds(p, case, &outputs)) {
                self.relieve(p, &mut relieved);
            }
            if relieved == before {
                return End::Stuck;
            }
        }
        unreachable!("every round relieves something more")
    }

    /// Whether a run of the corrected algorithm relieves an output both ways, or relieves one that a simple
    /// product holds: what the compiler refuses even if the outputs are safe in the end.
    pub fn contradicts(&self, case: &Case, commands: &[bool]) -> bool {
        let forced = self.forced(case);
        let mut relieved = vec![[false; 2]; self.outputs];
        loop {
            let outputs = Self::select(&forced, &relieved, commands);
            let before = relieved.clone();
            for p in self.combined().filter(|p| self.holds(p, case, &outputs)) {
                self.relieve(p, &mut relieved);
            }
            let clash = |(fs, fc): (&[bool; 2], &[bool; 2])| (fs[0] || fc[0]) && (fs[1] || fc[1]);
            if forced.iter().zip(&relieved).any(clash) {
                return true;
            }
            if relieved == before {
                return false;
            }
        }
    }

    /// Reliefs in the order of the products, at once, until nothing is violated.
    fn sweeps(&self, case: &Case, commands: &[bool]) -> End {
        let forced = self.forced(case);
        let mut outputs = Self::select(&forced, &vec![[false; 2]; self.outputs], commands);
        // There are no more outputs than this to be at before one comes back.
        for sweep in 0..=1usize << self.outputs {
            if self.safe(case, &outputs) {
                return End::Safe(outputs, sweep);
            }
            for p in self.combined() {
                if self.holds(p, case, &outputs) {
                    for &(o, negated) in p.outputs.iter().filter(|(o, _)| p.yields.contains(o)) {
                        outputs[o] = !forced[o][0] && negated || forced[o][1];
                    }
                }
            }
        }
        End::Stuck
    }

    /// Figure 7 of the paper on logical constraints, as it is printed: forcings are forgotten, the counter decides, and the fallback
    /// asks simple constraints only. Returns the outputs, and whether they are the fallback.
    pub fn published(&self, case: &Case, commands: &[bool]) -> (Vec<bool>, bool) {
        let forced = self.forced(case);
        let count = self.combined().count();
        let mut relieved = vec![[false; 2]; self.outputs];
        let mut outputs = Vec::new();
        let (mut flag, mut turns) = (true, 0);
        while flag && turns < count + 1 {
            outputs = Self::select(&forced, &relieved, commands);
            let violated: Vec<&Product> = self.combined().filter(|p| self.holds(p, case, &outputs)).collect();
            flag = !violated.is_empty();
            turns += 1;
            relieved = vec![[false; 2]; self.outputs];
            violated.iter().for_each(|p| self.relieve(p, &mut relieved));
        }
        if turns > count {
            return (forced.iter().map(|[fs0, fs1]| !fs0 && *fs1).collect(), true);
        }
        (outputs, false)
    }
}
