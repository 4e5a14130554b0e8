//! Models of any size.

use super::rng::Rng;
use std::fmt::Write;

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
    let mut rng = Rng::new(7);
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
                    let kind = if s == 0 {
                        "initial"
                    } else if s + 1 == shape.steps {
                        "final"
                    } else {
                        ""
                    };
                    let o = rng.below(outputs);
                    let _ =
                        writeln!(t, "{kind} state S{m}x{r}x{p}x{s} {{ drives O{o} when not I{} }}", rng.below(inputs));
                }
                for s in 1..shape.steps {
                    let (i, j) = (rng.below(inputs), rng.below(inputs));
                    let _ = writeln!(t, "from S{m}x{r}x{p}x{} to S{m}x{r}x{p}x{s} when rise(I{i}) or not I{j}", s - 1);
                }
                let back = rng.below(shape.steps);
                let _ = writeln!(t, "from S{m}x{r}x{p}x{back} to S{m}x{r}x{p}x0 when I{}", rng.below(inputs));
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
        let _ = writeln!(t, "from M{m} to M{next} when I{} and I{}", rng.below(inputs), rng.below(inputs));
    }
    t.push_str("state Stopped\nfrom any to Stopped when STOP\nfrom Stopped to M0 when not STOP and I0\n");
    t.push_str("}\nsafety supervisor {\n");
    for o in 0..outputs {
        let _ = writeln!(t, "S{o}: never O{o} and I{} and STOP", rng.below(inputs));
        if o % 4 == 0 {
            let _ = writeln!(t, "K{o}: never rise(O{o}) and O{} yields O{o}", (o + 1) % outputs);
        }
    }
    t.push_str("}\n");
    t
}
