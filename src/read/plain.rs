//! Declarations that CODESYS and its kin write as text besides their lists, to whether both say the same.
//!
//! Which of the two an IDE goes by is not known, so a text that says anything else is refused, and so is what is not
//! taken here: types of more than one word, flags of whole lists, pragmas.

use super::xml::{self, Node};
use crate::base::iec::fold;

/// A variable: its list, name, address, type and initial value, folded and without white space.
type Declared = [String; 5];

/// Whether the text says what the lists of `owner`, a program or a list of global variables, say.
pub fn agrees(text: &str, owner: Node<'_>) -> bool {
    let lists: Vec<Node<'_>> = match owner.tag_name().name() {
        "pou" => xml::child(owner, "interface").into_iter().flat_map(xml::children).collect(),
        _ => vec![owner],
    };
    let listed: Vec<Declared> = lists
        .into_iter()
        .filter_map(|list| Some((section(list)?, list)))
        .flat_map(|(section, list)| xml::children_named(list, "variable").map(move |v| declared(section, v)))
        .collect();
    let name = xml::attribute(owner, "name").filter(|_| xml::is(owner, "pou"));
    without_comments(text).and_then(|text| read(&text, name)) == Some(listed)
}

fn section(list: Node<'_>) -> Option<&'static str> {
    Some(match list.tag_name().name() {
        "localVars" => "VAR",
        "inputVars" => "VAR_INPUT",
        "outputVars" => "VAR_OUTPUT",
        "externalVars" => "VAR_EXTERNAL",
        "globalVars" => "VAR_GLOBAL",
        _ => return None,
    })
}

fn declared(section: &str, variable: Node<'_>) -> Declared {
    let own = |name| compact(xml::attribute(variable, name).unwrap_or_default());
    let kind = xml::child(variable, "type").and_then(|n| xml::children(n).next());
    let kind = kind.map(|k| xml::attribute(k, "name").unwrap_or(k.tag_name().name())).unwrap_or_default();
    let value = xml::child(variable, "initialValue").and_then(|n| xml::child(n, "simpleValue"));
    let value = value.and_then(|n| xml::attribute(n, "value")).unwrap_or_default();
    [section.to_owned(), own("name"), own("address"), compact(kind), compact(value)]
}

fn compact(text: &str) -> String {
    fold(&text.split_whitespace().collect::<String>())
}

/// The text without comments and without the pragma that changes nothing in it; nothing if there is another one.
fn without_comments(text: &str) -> Option<String> {
    let mut found = String::new();
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        rest = if let Some(inner) = rest.strip_prefix("(*") {
            &inner[inner.find("*)")? + 2..]
        } else if rest.starts_with("//") {
            &rest[rest.find('\n').unwrap_or(rest.len())..]
        } else if let Some(inner) = rest.strip_prefix('{') {
            let end = inner.find('}')?;
            if inner[..end].split_whitespace().collect::<Vec<_>>() != ["attribute", "'qualified_only'"] {
                return None;
            }
            &inner[end + 1..]
        } else {
            found.push(c);
            &rest[c.len_utf8()..]
        };
    }
    Some(found)
}

/// The variables of the text, in their order; nothing if it is not understood.
fn read(text: &str, program: Option<&str>) -> Option<Vec<Declared>> {
    let spaced = text.replace(":=", " \u{1} ").replace(':', " : ").replace(';', " ; ").replace(',', " , ");
    let mut words = spaced.split_whitespace();
    if let Some(name) = program {
        let is = |word: Option<&str>, wanted: &str| word.is_some_and(|word| fold(word) == fold(wanted));
        if !is(words.next(), "PROGRAM") || !is(words.next(), name) {
            return None;
        }
    }
    let mut found = Vec::new();
    while let Some(section) = words.next().map(fold) {
        if !matches!(section.as_str(), "VAR" | "VAR_INPUT" | "VAR_OUTPUT" | "VAR_EXTERNAL" | "VAR_GLOBAL") {
            return None;
        }
        let mut open: Vec<&str> = Vec::new();
        loop {
            match words.next()? {
                ";" => found.append(&mut variables(&section, &std::mem::take(&mut open))?),
                end if open.is_empty() && fold(end) == "END_VAR" => break,
                word => open.push(word),
            }
        }
    }
    Some(found)
}

/// `A, B AT %IX0.0 : BOOL := TRUE`.
fn variables(section: &str, words: &[&str]) -> Option<Vec<Declared>> {
    let colon = words.iter().position(|w| *w == ":")?;
    let (names, kind) = (&words[..colon], &words[colon + 1..]);
    let at = names.iter().position(|w| fold(w) == "AT").unwrap_or(names.len());
    let address = match &names[at..] {
        [] => "",
        [_, address] => *address,
        _ => return None,
    };
    let value = match kind {
        [_] => String::new(),
        [_, "\u{1}", value @ ..] if !value.is_empty() => compact(&value.join(" ")),
        _ => return None,
    };
    let listed = names[..at].split(|w| *w == ",").map(|name| match name {
        [name] => Some([section.to_owned(), fold(name), fold(address), fold(kind[0]), value.clone()]),
        _ => None,
    });
    listed.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_says_what_the_lists_say_or_something_else() {
        let file = r#"<pou name="P"><interface><localVars><variable name="A"><type><BOOL/></type></variable><variable name="B" address="%IX0.0"><type><derived name="TON"/></type></variable></localVars><inputVars><variable name="N"><type><INT/></type><initialValue><simpleValue value="-3"/></initialValue></variable></inputVars></interface></pou>"#;
        let document = roxmltree::Document::parse(file).unwrap();
        let says = |text: &str| agrees(text, document.root_element());
        let good = "PROGRAM p\nVAR // words; END_VAR\n a: Bool; (* B : INT; *)\n B AT %ix0.0 : TON;\nEND_VAR\nVAR_INPUT N : INT := - 3; END_VAR\n";
        assert!(says(good));
        for (from, to) in [
            ("p\n", "Q\n"),
            ("a: Bool", "a: INT"),
            ("a: Bool", "a: Bool := TRUE"),
            ("a: Bool", "a: Bool :="),
            ("a: Bool", "a, C: Bool"),
            ("%ix0.0", "%ix0.1"),
            (":= - 3", ":= 3"),
            (":= - 3", ""),
            ("VAR_INPUT", "VAR_OUTPUT"),
            ("VAR //", "VAR RETAIN //"),
            ("VAR //", "{attribute 'init_on_onlchange'} VAR //"),
            ("END_VAR\nVAR_INPUT N : INT := - 3; END_VAR", "END_VAR"),
            ("; END_VAR\n", "; END_VAR VAR X : INT; END_VAR\n"),
        ] {
            assert!(good.contains(from) && !says(&good.replacen(from, to, 2)), "{from} {to}");
        }
        assert!(says(&good.replace("VAR //", "{attribute 'qualified_only'} VAR //")));
        for (list, word) in [("outputVars", "VAR_OUTPUT"), ("externalVars", "VAR_EXTERNAL")] {
            let document = file.replace("inputVars", list);
            let document = roxmltree::Document::parse(&document).unwrap();
            assert!(!agrees(good, document.root_element()));
            assert!(agrees(&good.replace("VAR_INPUT", word), document.root_element()), "{list}");
        }
    }
}
