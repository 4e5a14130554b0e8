//! Models by chance, and models of any size.

use chartwright::prove::random::Random;
use std::fmt::Write;

/// A state that has been written.
struct State {
    name: String,
    composite: bool,
    /// Whether each of its regions has a final state.
    ends: bool,
}

struct Writer {
    random: Random,
    inputs: usize,
    outputs: usize,
    variables: usize,
    states: Vec<State>,
    /// What is left of the number of states.
    left: usize,
    text: String,
}

/// A model with small charts that use everything the language has. Not every one keeps every rule.
pub fn random(seed: u64) -> String {
    let mut random = Random::new(seed.wrapping_mul(0x9e37_79b9) ^ 0x1234_5678);
    let (inputs, outputs, variables) = (1 + random.below(5), 1 + random.below(5), random.below(4));
    let left = 2 + random.below(16);
    let mut w = Writer { random, inputs, outputs, variables, states: Vec::new(), left, text: String::new() };
    let list = |prefix: &str, n: usize| (0..n).map(|i| format!("{prefix}{i}")).collect::<Vec<_>>().join(" ");
    let mut head = format!("machine M{seed}\ncycle 10ms\ninputs {{ {} }}\n", list("I", inputs));
    let _ = writeln!(head, "outputs {{ {} }}", list("O", outputs));
    if variables > 0 {
        let each = (0..variables).map(|i| format!("V{i}: BOOL{}", if w.random.below(3) == 0 { " := true" } else { "" }));
        let _ = writeln!(head, "variables {{ {} }}", each.collect::<Vec<_>>().join(" "));
    }
    for i in 0..outputs {
        let _ = writeln!(head, "actuator A{i} onoff by O{i}");
    }
    w.text = head;
    let charts = 1 + usize::from(w.random.below(4) == 0);
    for c in 0..charts {
        let _ = writeln!(w.text, "chart C{c} {{");
        if w.random.below(5) == 0 {
            for r in 0..2 {
                let _ = writeln!(w.text, "region Q{c}{r} {{");
                w.region(1);
                w.text.push_str("}\n");
            }
        } else {
            w.region(1);
        }
        w.text.push_str("}\n");
    }
    if w.random.below(2) == 0 {
        w.safety();
    }
    w.text
}

impl Writer {
    fn chance(&mut self, percent: usize) -> bool {
        self.random.below(100) < percent
    }

    /// The inside of a region; returns whether it has a final state.
    fn region(&mut self, depth: usize) -> bool {
        let first = self.states.len();
        let count = 1 + self.random.below(4);
        let mut own = Vec::new();
        let mut ends = false;
        for i in 0..count {
            if i > 0 && self.left == 0 {
                break;
            }
            self.left = self.left.saturating_sub(1);
            let name = format!("S{}", self.states.len());
            let index = self.states.len();
            self.states.push(State { name: name.clone(), composite: false, ends: false });
            own.push(index);
            let initial = if i == 0 { "initial " } else { "" };
            let kind = self.random.below(10);
            if i > 0 && kind < 2 {
                ends = true;
                let _ = writeln!(self.text, "final state {name} {{");
                self.behaviour();
                self.tidy();
                continue;
            } else if kind < 5 && depth < 4 && self.left > 0 {
                self.states[index].composite = true;
                if kind == 2 {
                    let _ = writeln!(self.text, "{initial}parallel state {name} {{");
                    let mut all = true;
                    for r in 0..2 + self.random.below(2) {
                        let _ = writeln!(self.text, "region R{index}{r} {{");
                        all &= self.region(depth + 1);
                        self.text.push_str("}\n");
                    }
                    self.states[index].ends = all;
                } else {
                    let _ = writeln!(self.text, "{initial}state {name} {{");
                    let ends = self.region(depth + 1);
                    self.states[index].ends = ends;
                }
                self.behaviour();
            } else {
                let _ = writeln!(self.text, "{initial}state {name} {{");
                self.behaviour();
                self.tidy();
                continue;
            }
            self.text.push_str("}\n");
        }
        for (i, &s) in own.iter().enumerate().skip(1) {
            let from = own[self.random.below(i)];
            self.transition(from, s);
        }
        for _ in 0..self.random.below(4) {
            let from = own[self.random.below(own.len())];
            let to = if self.chance(30) {
                // Into one of them.
                first + self.random.below(self.states.len() - first)
            } else {
                own[self.random.below(own.len())]
            };
            if self.chance(15) {
                let guard = self.guard(2, Some(to));
                let _ = writeln!(self.text, "from any to {} when {guard}", self.states[to].name);
            } else if self.chance(25) {
                let from = first + self.random.below(self.states.len() - first);
                self.transition(from, to);
            } else {
                self.transition(from, to);
            }
        }
        ends
    }

    /// Closes the braces, or takes them away if nothing stands in them.
    fn tidy(&mut self) {
        if let Some(without) = self.text.strip_suffix(" {\n") {
            self.text = format!("{without}\n");
        } else {
            self.text.push_str("}\n");
        }
    }

    fn transition(&mut self, from: usize, to: usize) {
        let (name, target) = (self.states[from].name.clone(), self.states[to].name.clone());
        let priority = if self.chance(20) { format!(" priority {}", 1 + self.random.below(9)) } else { String::new() };
        let guard = if self.states[from].ends && self.chance(40) {
            if self.chance(50) { String::new() } else { format!(" when done and {}", self.guard(1, None)) }
        } else if !self.states[from].composite && self.chance(4) {
            String::new()
        } else {
            format!(" when {}", self.guard(2, None))
        };
        let effect = if self.variables > 0 && self.chance(20) {
            let v = self.random.below(self.variables);
            format!(" then {} V{v}", if self.chance(50) { "set" } else { "reset" })
        } else {
            String::new()
        };
        let _ = writeln!(self.text, "from {name} to {target}{priority}{guard}{effect}");
    }

    fn behaviour(&mut self) {
        for _ in 0..self.random.below(3) {
            let o = self.random.below(self.outputs);
            let when = if self.chance(40) { format!(" when {}", self.guard(2, None)) } else { String::new() };
            let _ = writeln!(self.text, "drives O{o}{when}");
        }
        if self.variables > 0 && self.chance(20) {
            let v = self.random.below(self.variables);
            let when = if self.chance(60) { format!(" when {}", self.guard(2, None)) } else { String::new() };
            let verb = if self.chance(50) { "sets" } else { "resets" };
            let _ = writeln!(self.text, "{verb} V{v}{when}");
        }
    }

    fn guard(&mut self, depth: usize, _: Option<usize>) -> String {
        if depth > 0 && self.chance(45) {
            let (l, r) = (self.guard(depth - 1, None), self.guard(depth - 1, None));
            let word = ["and", "and", "or", "or", "xor"][self.random.below(5)];
            let e = format!("({l} {word} {r})");
            return if self.chance(20) { format!("not {e}") } else { e };
        }
        let not = if self.chance(30) { "not " } else { "" };
        let i = self.random.below(self.inputs);
        let o = self.random.below(self.outputs);
        let s = self.random.below(self.states.len().max(1));
        let atom = match self.random.below(16) {
            0..=5 => format!("I{i}"),
            6 => format!("rise(I{i})"),
            7 => format!("fall(I{i})"),
            8 => format!("prev(I{i})"),
            9 => format!("prev(O{o})"),
            10 | 11 if self.variables > 0 => format!("V{}", self.random.below(self.variables)),
            12 | 13 if !self.states.is_empty() => format!("in({})", self.states[s].name),
            14 if !self.states.is_empty() && self.states[s].ends => format!("done({})", self.states[s].name),
            _ => format!("I{i}"),
        };
        format!("{not}{atom}")
    }

    fn safety(&mut self) {
        self.text.push_str("safety supervisor {\n");
        for c in 0..1 + self.random.below(5) {
            let mut outputs: Vec<usize> = Vec::new();
            for _ in 0..1 + self.random.below(3) {
                let o = self.random.below(self.outputs);
                if !outputs.contains(&o) {
                    outputs.push(o);
                }
            }
            let mut parts: Vec<String> = outputs
                .iter()
                .map(|o| match self.random.below(6) {
                    0 => format!("rise(O{o})"),
                    1 => format!("fall(O{o})"),
                    2 | 3 => format!("not O{o}"),
                    _ => format!("O{o}"),
                })
                .collect();
            for _ in 0..self.random.below(3) {
                let i = self.random.below(self.inputs);
                let o = self.random.below(self.outputs);
                parts.push(match self.random.below(5) {
                    0 => format!("not I{i}"),
                    1 => format!("rise(I{i})"),
                    2 => format!("(I{i} or prev(O{o}))"),
                    _ => format!("I{i}"),
                });
            }
            let yields = if outputs.len() > 1 {
                let y = outputs[self.random.below(outputs.len())];
                format!(" yields O{y}")
            } else {
                String::new()
            };
            let _ = writeln!(self.text, "K{c}: never {}{yields}", parts.join(" and "));
        }
        if self.chance(40) {
            let (i, j) = (self.random.below(self.inputs), self.random.below(self.inputs));
            let _ = writeln!(self.text, "assume P: never I{i} and not prev(I{j})");
        }
        self.text.push_str("}\n");
    }
}

/// What a large model looks like.
#[derive(Clone, Copy)]
pub struct Shape {
    /// Operating modes: states of the outermost region.
    pub modes: usize,
    /// Regions side by side in each mode.
    pub regions: usize,
    /// Composite states of each region.
    pub phases: usize,
    /// Elementary states of each of them.
    pub steps: usize,
}

impl Shape {
    /// How many states that makes.
    pub fn states(self) -> usize {
        self.modes * (1 + self.regions * self.phases * (1 + self.steps))
    }
}

/// A regular model: modes in a ring, each parallel, with phases that follow each other and cycles of
/// steps inside them, every output forbidden by something, and an emergency stop over all.
pub fn large(shape: Shape) -> String {
    let (inputs, outputs) = (200, 100);
    let mut random = Random::new(7);
    let list = |prefix: &str, n: usize| (0..n).map(|i| format!("{prefix}{i}")).collect::<Vec<_>>().join(" ");
    let mut t = format!("machine Large\ncycle 10ms\ninputs {{ {} STOP }}\n", list("I", inputs));
    let _ = writeln!(t, "outputs {{ {} }}", list("O", outputs));
    for i in 0..outputs {
        let _ = writeln!(t, "actuator A{i} onoff by O{i}");
    }
    t.push_str("chart C {\n");
    for m in 0..shape.modes {
        let _ = writeln!(t, "{}parallel state M{m} {{", if m == 0 { "initial " } else { "" });
        for r in 0..shape.regions {
            let _ = writeln!(t, "region R{m}x{r} {{");
            for p in 0..shape.phases {
                let _ = writeln!(t, "{}state P{m}x{r}x{p} {{", if p == 0 { "initial " } else { "" });
                for s in 0..shape.steps {
                    let kind = if s == 0 { "initial" } else if s + 1 == shape.steps { "final" } else { "" };
                    let o = random.below(outputs);
                    let _ = writeln!(t, "{kind} state S{m}x{r}x{p}x{s} {{ drives O{o} when not I{} }}", random.below(inputs));
                }
                for s in 1..shape.steps {
                    let (i, j) = (random.below(inputs), random.below(inputs));
                    let _ = writeln!(t, "from S{m}x{r}x{p}x{} to S{m}x{r}x{p}x{s} when rise(I{i}) or not I{j}", s - 1);
                }
                let back = random.below(shape.steps);
                let _ = writeln!(t, "from S{m}x{r}x{p}x{back} to S{m}x{r}x{p}x0 when I{}", random.below(inputs));
                t.push_str("}\n");
            }
            for p in 0..shape.phases {
                let next = (p + 1) % shape.phases;
                let beside = (r + 1) % shape.regions;
                let _ = writeln!(t, "from P{m}x{r}x{p} to P{m}x{r}x{next} when done and in(P{m}x{beside}x{p})");
            }
            t.push_str("}\n");
        }
        t.push_str("}\n");
    }
    for m in 0..shape.modes {
        let next = (m + 1) % shape.modes;
        let _ = writeln!(t, "from M{m} to M{next} when I{} and I{}", random.below(inputs), random.below(inputs));
    }
    t.push_str("state Stopped\nfrom any to Stopped when STOP\nfrom Stopped to M0 when not STOP and I0\n");
    t.push_str("}\nsafety supervisor {\n");
    for o in 0..outputs {
        let _ = writeln!(t, "S{o}: never O{o} and I{} and STOP", random.below(inputs));
        if o % 4 == 0 {
            let _ = writeln!(t, "K{o}: never rise(O{o}) and O{} yields O{o}", (o + 1) % outputs);
        }
    }
    t.push_str("}\n");
    t
}
