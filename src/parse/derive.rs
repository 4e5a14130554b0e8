//! The parser's pairs to what is forbidden and what is to be derived.

use super::Rule;
use super::build::{name, span, text};
use crate::ir::ast::{Derive, Forbid, Name, Place};
use pest::iterators::Pair;

pub fn forbid(p: Pair<'_, Rule>) -> Forbid {
    let (mut named, mut unless, mut about) = (None, false, None);
    let mut places = Vec::new();
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::name => named = Some(name(p)),
            Rule::kw_unless => unless = true,
            Rule::place_of => places.push(place(p)),
            Rule::text => about = Some(text(p)),
            _ => {}
        }
    }
    let [first, second] = <[Place; 2]>::try_from(places).expect("two places stand there");
    Forbid { name: named.expect("it has a name"), first, unless, second, text: about }
}

fn place(p: Pair<'_, Rule>) -> Place {
    let mut names = p.into_inner().filter(|p| p.as_rule() == Rule::name).map(name);
    Place { actuator: names.next().expect("an actuator stands there"), position: names.next() }
}

pub fn derive(p: Pair<'_, Rule>) -> Derive {
    let mut item = Derive { names: Vec::new(), edges: None, except: Vec::new(), span: span(&p) };
    let mut except = false;
    for p in p.into_inner() {
        match p.as_rule() {
            Rule::kw_except => except = true,
            Rule::by_edges => item.edges = Some(span(&p)),
            Rule::derived => {
                let names: Vec<Name> = p.into_inner().filter(|p| p.as_rule() == Rule::name).map(name).collect();
                *(if except { &mut item.except } else { &mut item.names }) = names;
            }
            _ => {}
        }
    }
    item
}
