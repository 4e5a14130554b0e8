//! All reachable states, and the loops among them in which the answer stays open and all that makes a run fair comes.
//!
//! The states from which such a loop can be reached without an answer are what is left when those are taken away,
//! again and again, that cannot go on to some fairness (Emerson, Lei, 1986).

use super::super::aig::Lit;
use super::super::bdd::Edge;
use super::super::limits::{Limit, Limits, Stop};
use super::super::path;
use super::super::relation::Relation;
use super::super::system::{System, Trace};
use super::monitor::{self, States};

/// A run into such a loop; nothing if there is none. `progress` is told after how many scans it is.
pub fn find(
    system: &System,
    after: Lit,
    then: Lit,
    limits: &Limits,
    stop: Stop<'_>,
    progress: &mut dyn FnMut(usize),
) -> Result<Option<Trace>, Limit> {
    let States { system: monitored, open, came } = monitor::states(system, after, then);
    let asked: Vec<Lit> = came.iter().copied().chain([open]).collect();
    let relation = Relation::new(&monitored, &asked, limits, stop)?;
    let mut search = Search { system: &monitored, relation, keep: Vec::new() };
    let rings = search.reach(progress)?;
    let mut hull = search.latch(open)?;
    let mut reached = Edge::FALSE;
    for &ring in &rings {
        reached = search.relation.bdd.or(reached, ring)?;
    }
    hull = search.relation.bdd.and(hull, reached)?;
    search.keep.push(reached);
    let mut goals = Vec::new();
    for came in came {
        goals.push(search.latch(came)?);
    }
    if goals.is_empty() {
        goals.push(Edge::TRUE);
    }
    search.keep.extend(&goals);
    hull = search.hull(hull, &goals)?;
    if hull == Edge::FALSE {
        return Ok(None);
    }
    search.keep.push(hull);
    let path = search.run(&rings, hull, &goals)?;
    let trace = path::run(&monitored, &search.relation.latches, &path, None, stop)?;
    let mut initial = trace.initial;
    initial.truncate(system.latches.len());
    Ok(Some(Trace { initial, ..trace }))
}

struct Search<'s, 'a> {
    system: &'s System,
    relation: Relation<'a>,
    /// What must not be lost.
    keep: Vec<Edge>,
}

/// A state, over the latches that matter.
type State = Vec<bool>;

impl Search<'_, '_> {
    /// States first met after 0, 1, 2, … scans.
    fn reach(&mut self, progress: &mut dyn FnMut(usize)) -> Result<Vec<Edge>, Limit> {
        let mut fresh = self.relation.initial;
        let mut reached = fresh;
        let mut rings = Vec::new();
        while fresh != Edge::FALSE {
            progress(rings.len());
            rings.push(fresh);
            self.keep.push(fresh);
            self.make_room(&[reached]);
            let after = self.image(fresh, &[reached])?;
            fresh = self.relation.bdd.and(after, !reached)?;
            reached = self.relation.bdd.or(reached, fresh)?;
        }
        Ok(rings)
    }

    fn make_room(&mut self, also: &[Edge]) {
        let keep = [&self.keep, also].concat();
        self.relation.make_room(&keep);
    }

    fn image(&mut self, from: Edge, also: &[Edge]) -> Result<Edge, Limit> {
        let keep = [&self.keep, also].concat();
        self.relation.image(from, &keep)
    }

    fn preimage(&mut self, to: Edge, also: &[Edge]) -> Result<Edge, Limit> {
        let keep = [&self.keep, also].concat();
        self.relation.preimage(to, &keep)
    }

    /// The states in which a latch is TRUE.
    fn latch(&mut self, leaf: Lit) -> Result<Edge, Limit> {
        let of = |&l: &usize| self.system.latches[l].leaf == leaf;
        let place = self.relation.latches.iter().position(of).expect("it was asked for");
        self.relation.bdd.var(self.relation.now[place])
    }

    /// Those of the states from which each goal can be reached again and again inside them.
    fn hull(&mut self, states: Edge, goals: &[Edge]) -> Result<Edge, Limit> {
        let mut hull = states;
        loop {
            let before = hull;
            for &goal in goals {
                self.make_room(&[hull, before]);
                let mut way = self.relation.bdd.and(hull, goal)?;
                let mut fresh = way;
                while fresh != Edge::FALSE {
                    self.make_room(&[hull, before, way, fresh]);
                    let from = self.preimage(fresh, &[hull, before, way])?;
                    let from = self.relation.bdd.and(from, hull)?;
                    fresh = self.relation.bdd.and(from, !way)?;
                    way = self.relation.bdd.or(way, fresh)?;
                }
                // At least one scan further.
                let from = self.preimage(way, &[hull, before])?;
                hull = self.relation.bdd.and(hull, from)?;
            }
            if hull == before {
                return Ok(hull);
            }
        }
    }

    /// States from the beginning into a loop, the last of which has been there before.
    fn run(&mut self, rings: &[Edge], hull: Edge, goals: &[Edge]) -> Result<Vec<State>, Limit> {
        let mut ring = 0;
        let mut here = self.relation.bdd.and(rings[0], hull)?;
        while here == Edge::FALSE {
            ring += 1;
            here = self.relation.bdd.and(rings[ring], hull)?;
        }
        let mut path = self.back(&rings[..ring], here)?;
        loop {
            let begin = path.last().expect("it has a state").clone();
            for &goal in goals {
                let way = self.way(path.last().expect("it has a state"), goal, hull)?;
                path.extend(way.expect("in the hull each goal can be reached"));
            }
            // If nothing leads back, the loops are further on; that happens only so often.
            let only = self.relation.only(&begin)?;
            if let Some(way) = self.way(path.last().expect("it has a state"), only, hull)? {
                path.extend(way);
                return Ok(path);
            }
        }
    }

    /// A shortest way of at least one scan inside `hull` from a state to a goal, without its beginning.
    fn way(&mut self, from: &State, goal: Edge, hull: Edge) -> Result<Option<Vec<State>>, Limit> {
        let mut rings = vec![self.relation.only(from)?];
        let mut seen = Edge::FALSE;
        loop {
            let also = [&rings[..], &[seen, goal, hull]].concat();
            self.make_room(&also);
            let fresh = self.image(*rings.last().expect("there is one"), &also)?;
            let fresh = self.relation.bdd.and(fresh, hull)?;
            let fresh = self.relation.bdd.and(fresh, !seen)?;
            if fresh == Edge::FALSE {
                return Ok(None);
            }
            let there = self.relation.bdd.and(fresh, goal)?;
            if there != Edge::FALSE {
                let path = self.back(&rings, there)?;
                return Ok(Some(path[1..].to_vec()));
            }
            seen = self.relation.bdd.or(seen, fresh)?;
            rings.push(fresh);
        }
    }

    /// A state of each ring, and one of `end` behind them, each one scan after the other.
    fn back(&mut self, rings: &[Edge], end: Edge) -> Result<Vec<State>, Limit> {
        let mut path = vec![self.one_of(end)];
        for &ring in rings.iter().rev() {
            let to = self.relation.only(path.last().expect("it has a state"))?;
            let also = [rings, &[to]].concat();
            let before = self.preimage(to, &also)?;
            let before = self.relation.bdd.and(before, ring)?;
            path.push(self.one_of(before));
        }
        path.reverse();
        Ok(path)
    }

    fn one_of(&self, states: Edge) -> State {
        self.relation.state(&self.relation.bdd.pick(states))
    }
}
