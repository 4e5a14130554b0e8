//! The order in which the steps and transitions of a drawing stand in a text.
//!
//! A drawing has no order, but some of what it means depends on one: which association writes last,
//! which of two transitions without priorities is tested first. It is the order of the texts that
//! Beremiz generates. Elements are first *noted* in document order, where noting a step notes the
//! transitions into it, and noting a transition the steps before it; then *written* from each
//! initial step on: a step, the transitions out of it as noted, and after each its targets. What is
//! not reached so is not written.

use std::collections::BTreeSet;

/// A drawing, all things by number.
#[derive(Debug, Default)]
pub struct Drawing {
    /// What stands in the document, in its order.
    pub elements: Vec<Element>,
    /// For each step, whether it is initial.
    pub initial: Vec<bool>,
    /// For each step, the transitions that lead into it by lines.
    pub into: Vec<Vec<usize>>,
    /// For each transition, the steps before it.
    pub before: Vec<Vec<usize>>,
}

/// An element that matters for the order.
#[derive(Debug)]
pub enum Element {
    /// A step.
    Step(usize),
    /// An action block of a step.
    Action(usize),
    /// A transition.
    Transition(usize),
    /// A jump to a step, and the transitions that lead into it.
    Jump(usize, Vec<usize>),
}

/// The order.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Order {
    /// The steps, as they are written.
    pub steps: Vec<usize>,
    /// The transitions, as they are written.
    pub transitions: Vec<usize>,
    /// For each transition, the steps after it.
    pub after: Vec<Vec<usize>>,
    /// The transitions, as they are noted; those that are not written as well.
    pub noted: Vec<usize>,
    /// The initial step that is noted first.
    pub first: Option<usize>,
}

/// Orders a drawing.
pub fn order(drawing: &Drawing) -> Order {
    enum Task {
        Step(usize),
        Transition(usize),
        Enters(usize, usize),
        Leaves(usize, usize),
    }
    let (steps, transitions) = (drawing.initial.len(), drawing.before.len());
    let mut order = Order { after: vec![Vec::new(); transitions], ..Order::default() };
    let (mut noted_step, mut noted_transition) = (vec![false; steps], vec![false; transitions]);
    let mut out_of: Vec<Vec<usize>> = vec![Vec::new(); steps];
    let mut initial = Vec::new();
    let mut entered = BTreeSet::new();
    // Tasks stand in reverse: the last one comes first.
    let mut tasks = Vec::new();
    for element in &drawing.elements {
        match element {
            Element::Step(step) | Element::Action(step) => tasks.push(Task::Step(*step)),
            Element::Transition(transition) => tasks.push(Task::Transition(*transition)),
            Element::Jump(to, from) => {
                for &transition in from.iter().rev() {
                    tasks.push(Task::Enters(transition, *to));
                    tasks.push(Task::Transition(transition));
                }
            }
        }
        while let Some(task) = tasks.pop() {
            match task {
                Task::Step(step) => {
                    if !std::mem::replace(&mut noted_step[step], true) {
                        if drawing.initial[step] {
                            initial.push(step);
                        }
                        for &transition in drawing.into[step].iter().rev() {
                            tasks.push(Task::Enters(transition, step));
                            tasks.push(Task::Transition(transition));
                        }
                    }
                }
                Task::Transition(transition) => {
                    if !std::mem::replace(&mut noted_transition[transition], true) {
                        order.noted.push(transition);
                        for &step in drawing.before[transition].iter().rev() {
                            tasks.push(Task::Leaves(step, transition));
                            tasks.push(Task::Step(step));
                        }
                    }
                }
                Task::Enters(transition, step) => {
                    if entered.insert((transition, step)) {
                        order.after[transition].push(step);
                    }
                }
                Task::Leaves(step, transition) => out_of[step].push(transition),
            }
        }
    }
    order.first = initial.first().copied();

    let (mut written_step, mut written_transition) = (vec![false; steps], vec![false; transitions]);
    for step in initial {
        tasks.push(Task::Step(step));
        while let Some(task) = tasks.pop() {
            match task {
                Task::Step(step) => {
                    if !std::mem::replace(&mut written_step[step], true) {
                        order.steps.push(step);
                        tasks.extend(out_of[step].iter().rev().map(|&t| Task::Transition(t)));
                    }
                }
                Task::Transition(transition) => {
                    if !std::mem::replace(&mut written_transition[transition], true) {
                        order.transitions.push(transition);
                        tasks.extend(order.after[transition].iter().rev().map(|&s| Task::Step(s)));
                    }
                }
                // Only noting has these.
                Task::Enters(..) | Task::Leaves(..) => {}
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_above_its_transition_comes_first() {
        // Step 1 stands above the transitions 0 and 1 out of step 0, and only 1 leads into it.
        let drawing = Drawing {
            elements: vec![
                Element::Step(0),
                Element::Step(1),
                Element::Transition(0),
                Element::Step(2),
                Element::Transition(1),
            ],
            initial: vec![true, false, false],
            into: vec![vec![], vec![1], vec![0]],
            before: vec![vec![0], vec![0]],
        };
        let order = order(&drawing);
        assert_eq!(order.transitions, [1, 0]);
        assert_eq!(order.steps, [0, 1, 2]);
        assert_eq!(order.after, [[2], [1]]);
    }

    #[test]
    fn long_chains_against_the_document_order_do_not_exhaust_the_stack() {
        let n = 200_000;
        let drawing = Drawing {
            elements: (0..n).rev().map(Element::Step).collect(),
            initial: (0..n).map(|s| s == 0).collect(),
            into: (0..n).map(|s| if s == 0 { vec![] } else { vec![s - 1] }).collect(),
            before: (0..n - 1).map(|t| vec![t]).collect(),
        };
        let order = order(&drawing);
        assert_eq!(order.steps, (0..n).collect::<Vec<_>>());
    }
}
