//! All reachable states at once: the exact engine.
//!
//! Breadth first, so that the first set in which something shows tells how many scans it takes, and the
//! sets before it, one inside the other like the rings of an onion, lead back to the beginning.

use super::aig::Lit;
use super::bdd::Edge;
use super::count::Count;
use super::limits::{Limit, Limits, Stop};
use super::path;
use super::relation::Relation;
use super::system::{Claim, Property, System, Trace};

/// What the exact engine has found out.
pub struct Explored {
    /// For each claim, whether it holds; nothing where that is not known.
    pub verdicts: Vec<Option<Result<(), Trace>>>,
    /// For each claim, whether it is known that some run shows that it does not hold, though that run was not found again.
    pub unshown: Vec<bool>,
    /// How many states are reachable, over those latches that the claims depend on; if all were found.
    pub states: Option<Count>,
    /// After how many scans no new state was found, or how far the search came.
    pub scans: usize,
    /// Why it did not come to an end.
    pub limit: Option<Limit>,
}

/// Explores all that can be reached, for all claims together. `progress` is told after how many scans it is.
pub fn explore(system: &System, limits: &Limits, stop: Stop<'_>, progress: &mut dyn FnMut(usize)) -> Explored {
    let claims = &system.claims;
    let (verdicts, unshown) = (vec![None; claims.len()], vec![false; claims.len()]);
    let mut explored = Explored { verdicts, unshown, states: None, scans: 0, limit: None };
    let asked: Vec<Lit> = claims.iter().filter_map(|c| literal(c.property)).collect();
    let outcome = Relation::new(system, &asked, limits, stop).and_then(|relation| {
        let search = Search {
            system,
            claims,
            relation,
            rings: Vec::new(),
            reached: Edge::FALSE,
            from: Edge::FALSE,
            looked: 0,
            unseen: Edge::FALSE,
            stop,
        };
        search.run(&mut explored, progress)
    });
    explored.limit = outcome.err();
    explored
}

fn literal(property: Property) -> Option<Lit> {
    match property {
        Property::Never(l) | Property::AlwaysPossible(l) => Some(l),
        Property::NeverStuck | Property::Eventually { .. } => None,
    }
}

struct Search<'s, 'a> {
    system: &'s System,
    claims: &'s [Claim],
    relation: Relation<'a>,
    /// States first met after 0, 1, 2, … scans.
    rings: Vec<Edge>,
    reached: Edge,
    /// The newest ring, and of what was reached before it as much as makes it small: nothing new comes from there.
    from: Edge,
    /// How many rings have been looked at.
    looked: usize,
    /// Those together that are being looked at.
    unseen: Edge,
    stop: Stop<'a>,
}

impl Search<'_, '_> {
    fn run(mut self, explored: &mut Explored, progress: &mut dyn FnMut(usize)) -> Result<(), Limit> {
        let mut fresh = self.relation.initial;
        self.reached = fresh;
        self.from = fresh;
        while fresh != Edge::FALSE {
            if (self.stop)() {
                return Err(Limit::Stopped);
            }
            self.rings.push(fresh);
            explored.scans = self.rings.len() - 1;
            progress(explored.scans);
            // Of many rings together a claim is asked at once: which of them shows it is found out only if one does.
            if self.rings.len() >= self.looked + (self.looked / 4).max(1) {
                self.look(explored, false)?;
            }
            self.make_room();
            let keep = self.keep();
            let after = self.relation.image(self.from, &keep)?;
            fresh = self.relation.bdd.and(after, !self.reached)?;
            self.from = self.relation.bdd.restrict(fresh, !self.reached)?;
            self.reached = self.relation.bdd.or(self.reached, fresh)?;
        }
        self.look(explored, true)?;
        explored.states = Some(self.relation.bdd.count(self.reached, &self.relation.now));
        for (i, claim) in self.claims.iter().enumerate() {
            if matches!(claim.property, Property::AlwaysPossible(_)) {
                let goal = self.index(i);
                let keep = self.keep();
                let goal = self.relation.possible(goal, self.reached, &keep)?;
                let lost = self.lost(goal)?;
                if lost == Edge::FALSE {
                    explored.verdicts[i] = Some(Ok(()));
                } else {
                    self.show(i, lost, None, explored);
                }
            }
        }
        Ok(())
    }

    /// Frees what nobody needs when half of what is allowed is taken.
    fn make_room(&mut self) {
        let keep = self.keep();
        self.relation.make_room(&keep);
    }

    /// All that must not be lost.
    fn keep(&self) -> Vec<Edge> {
        self.rings.iter().copied().chain([self.reached, self.from, self.unseen]).collect()
    }

    /// The index by which the relation knows a claim's literal.
    fn index(&self, claim: usize) -> usize {
        self.claims[..claim].iter().filter(|c| literal(c.property).is_some()).count()
    }

    /// Looks at those rings at which nobody has looked yet. What shows in none of them when they are the `last` holds. Runs are found when
    /// it is known what shows: so whatever keeps one from being found loses nothing else.
    fn look(&mut self, explored: &mut Explored, last: bool) -> Result<(), Limit> {
        self.unseen = Edge::FALSE;
        for ring in std::mem::replace(&mut self.looked, self.rings.len())..self.rings.len() {
            self.unseen = self.relation.bdd.or(self.unseen, self.rings[ring])?;
        }
        let mut shows = Vec::new();
        for (i, claim) in self.claims.iter().enumerate() {
            if explored.verdicts[i].is_some() || explored.unshown[i] {
                continue;
            }
            let keep = self.keep();
            let is_possible = match claim.property {
                Property::Never(_) => self.relation.is_possible(self.index(i), self.unseen, &keep)?,
                Property::NeverStuck => {
                    let alive = self.relation.possible(self.relation.anything(), self.unseen, &keep)?;
                    self.relation.bdd.and(self.unseen, !alive)? != Edge::FALSE
                }
                Property::AlwaysPossible(_) | Property::Eventually { .. } => continue,
            };
            match (is_possible, last) {
                (true, _) => shows.push(i),
                (false, true) => explored.verdicts[i] = Some(Ok(())),
                (false, false) => {}
            }
        }
        shows.iter().for_each(|&i| explored.unshown[i] = true);
        for i in shows {
            let keep = self.keep();
            let (found, bad) = match self.claims[i].property {
                Property::Never(bad) => (self.relation.possible(self.index(i), self.unseen, &keep)?, Some(bad)),
                _ => {
                    let alive = self.relation.possible(self.relation.anything(), self.unseen, &keep)?;
                    (self.relation.bdd.and(self.unseen, !alive)?, None)
                }
            };
            self.show(i, found, bad, explored);
        }
        Ok(())
    }

    /// Leads to one of the states, in which something shows that speaks against a claim.
    fn show(&mut self, claim: usize, states: Edge, bad: Option<Lit>, explored: &mut Explored) {
        let found = self.lead(states, bad);
        explored.unshown[claim] = found.is_err();
        explored.verdicts[claim] = found.ok().map(Err);
    }

    /// The reachable states from which `goal` cannot be reached.
    fn lost(&mut self, goal: Edge) -> Result<Edge, Limit> {
        let mut saved = self.relation.bdd.and(goal, self.reached)?;
        let mut fresh = saved;
        while fresh != Edge::FALSE {
            let keep: Vec<Edge> = self.rings.iter().copied().chain([self.reached, saved]).collect();
            self.relation.make_room(&[&keep[..], &[fresh]].concat());
            let before = self.relation.preimage(fresh, &keep)?;
            let before = self.relation.bdd.and(before, self.reached)?;
            fresh = self.relation.bdd.and(before, !saved)?;
            saved = self.relation.bdd.or(saved, fresh)?;
        }
        self.relation.bdd.and(self.reached, !saved)
    }

    /// A shortest run that leads to one of `states`, which are reachable, and shows `bad` there.
    fn lead(&mut self, states: Edge, bad: Option<Lit>) -> Result<Trace, Limit> {
        let mut ring = 0;
        let mut here = self.relation.bdd.and(self.rings[0], states)?;
        while here == Edge::FALSE {
            ring += 1;
            here = self.relation.bdd.and(self.rings[ring], states)?;
        }
        let mut path = vec![self.one_of(here)];
        while ring > 0 {
            ring -= 1;
            let to = self.relation.only(path.last().expect("it has a state"))?;
            let keep = self.keep();
            let before = self.relation.preimage(to, &keep)?;
            let before = self.relation.bdd.and(before, self.rings[ring])?;
            path.push(self.one_of(before));
        }
        path.reverse();
        let trace = path::run(self.system, &self.relation.latches, &path, bad, self.stop)?;
        Ok(Trace { shortest: true, ..trace })
    }

    fn one_of(&self, states: Edge) -> Vec<bool> {
        self.relation.state(&self.relation.bdd.pick(states))
    }
}
