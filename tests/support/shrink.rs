//! A model that shows a fault to a smaller one that shows it, too.
//!
//! Works on items of text, so it knows no more of the language than that a state can stand without its
//! braces and a condition can be left out. What it proposes may be invalid; whoever asks for the fault
//! has to find that out.

use super::items::{self, Item};

/// Takes away what `fails` does not need, until nothing more can go. `fails` gets a model.
pub fn shrink(model: &[Item], mut fails: impl FnMut(&[Item]) -> bool) -> Vec<Item> {
    let mut best = model.to_vec();
    loop {
        let before = best.clone();
        for propose in [without_name, without_runs, opened, shortened] {
            // Each proposal is made for the model as it is now, by its number.
            let mut next = 0;
            loop {
                let proposals = propose(&best);
                let Some(found) = proposals.iter().skip(next).position(|p| **p != best[..] && fails(p)) else { break };
                next += found;
                best = proposals.into_iter().nth(next).expect("it was there");
            }
        }
        if best == before {
            return best;
        }
    }
}

/// For each name, all without the items that mention it.
fn without_name(model: &[Item]) -> Vec<Vec<Item>> {
    fn prune(items: &[Item], name: &str) -> Vec<Item> {
        let kept = items.iter().filter(|i| !items::words(i.head()).contains(&name));
        kept.map(|i| match i {
            Item::Line(_) => i.clone(),
            Item::Block(head, inner) => Item::Block(head.clone(), prune(inner, name)),
        })
        .collect()
    }
    let text = items::text(model);
    let names = items::words(&text).into_iter().filter(|w| w.ends_with(|c: char| c.is_ascii_digit()));
    names.map(|name| prune(model, name)).collect()
}

/// All without some neighbours: halves first, then quarters, at last single items.
fn without_runs(model: &[Item]) -> Vec<Vec<Item>> {
    let mut proposals = Vec::new();
    let mut length = model.len();
    while length > 0 {
        for from in (0..model.len()).step_by(length) {
            let to = (from + length).min(model.len());
            proposals.push([&model[..from], &model[to..]].concat());
        }
        length /= 2;
    }
    within(model, without_runs, &mut proposals);
    proposals
}

/// All with one block replaced by its head, by its content, or by that of one block in it.
fn opened(model: &[Item]) -> Vec<Vec<Item>> {
    let mut proposals = Vec::new();
    for (i, item) in model.iter().enumerate() {
        let Item::Block(head, inner) = item else { continue };
        let plain = head.replace("parallel ", "");
        let bare = plain.split(" controls ").next().unwrap_or_default().to_owned();
        let mut others: Vec<Vec<Item>> = vec![vec![Item::Line(bare.clone())], inner.clone()];
        for block in inner {
            if let Item::Block(_, content) = block {
                others.push(vec![Item::Block(bare.clone(), content.clone())]);
            }
        }
        if let Some((before, _)) = head.split_once(" controls ") {
            others.push(vec![Item::Block(before.into(), inner.clone())]);
        }
        for other in others {
            proposals.push([&model[..i], &other, &model[i + 1..]].concat());
        }
    }
    within(model, opened, &mut proposals);
    proposals
}

/// All with one head or line made shorter.
fn shortened(model: &[Item]) -> Vec<Vec<Item>> {
    let mut proposals = Vec::new();
    for (i, item) in model.iter().enumerate() {
        for shorter in shorter(item.head()) {
            let mut other = model.to_vec();
            match &mut other[i] {
                Item::Line(text) | Item::Block(text, _) => *text = shorter,
            }
            proposals.push(other);
        }
    }
    within(model, shortened, &mut proposals);
    proposals
}

/// Texts without a part, or with one literal instead of a condition.
fn shorter(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    for part in [" then ", " yields ", " as ", " at ", ", "] {
        if let Some((before, _)) = text.rsplit_once(part) {
            found.push(before.into());
        }
    }
    for word in ["initial ", "final "] {
        found.push(text.replacen(word, "", 1));
    }
    if let Some((before, rest)) = text.split_once(" priority ") {
        let after = rest.split_once(' ').map(|(_, after)| format!(" {after}")).unwrap_or_default();
        found.push(format!("{before}{after}"));
    }
    for keyword in [" when ", " never ", " sensor "] {
        let Some((before, rest)) = text.split_once(keyword) else { continue };
        let end = [" then ", " yields "].iter().filter_map(|k| rest.find(k)).min().unwrap_or(rest.len());
        let (condition, after) = rest.split_at(end);
        found.push(format!("{before}{after}"));
        let operands = condition.split([' ', '(', ')']).filter(|w| w.ends_with(|c: char| c.is_ascii_digit()));
        found.extend(operands.map(|o| format!("{before}{keyword}{o}{after}")));
        for operator in [" and ", " or ", " xor "] {
            for (at, _) in condition.match_indices(operator) {
                let (left, right) = (&condition[..at], &condition[at + operator.len()..]);
                found.extend([left, right].map(|side| format!("{before}{keyword}{}{after}", balanced(side))));
            }
        }
        if let Some(at) = condition.find("not ") {
            found.push(format!("{before}{keyword}{}{}{after}", &condition[..at], &condition[at + 4..]));
        }
    }
    // What is not shorter would be proposed for ever.
    found.retain(|f| f.len() < text.len());
    found
}

/// The text without parentheses that have no partner.
fn balanced(text: &str) -> String {
    let closing = text.matches(')').count();
    let opening = text.matches('(').count();
    let mut text = text.to_owned();
    for _ in closing..opening {
        let at = text.find('(').expect("there is one more than of the others");
        text.remove(at);
    }
    for _ in opening..closing {
        let at = text.rfind(')').expect("there is one more than of the others");
        text.remove(at);
    }
    text
}

/// The same for what stands between braces.
fn within(model: &[Item], propose: impl Fn(&[Item]) -> Vec<Vec<Item>>, proposals: &mut Vec<Vec<Item>>) {
    for (i, item) in model.iter().enumerate() {
        let Item::Block(head, inner) = item else { continue };
        for inner in propose(inner) {
            let mut other = model.to_vec();
            other[i] = Item::Block(head.clone(), inner);
            proposals.push(other);
        }
    }
}

#[test]
fn what_a_fault_does_not_need_goes() {
    use Item as I;
    let model = vec![
        I::line("machine M"),
        I::block("inputs", [I::line("In1"), I::line("In2")]),
        I::block(
            "chart Chart1",
            [
                I::block("initial state S1", [I::line("initial state S2")]),
                I::line("state S3"),
                I::line("from S1 to S3 when (In1 and In2) or In2"),
            ],
        ),
    ];
    let small = shrink(&model, |items| items::text(items).contains("to S3") && items::text(items).contains("In2"));
    assert_eq!(items::text(&small), "from S1 to S3 when In2\n");
}
