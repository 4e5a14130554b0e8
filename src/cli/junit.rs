//! Verdicts of scenarios to a report that CI servers read: JUnit XML.
//!
//! A suite is a model and what ran it, a case a scenario. Times are those of the machine, not of the
//! computer, so the same models give the same report.

use super::test::Test;
use quick_xml::Writer;
use quick_xml::events::{BytesText, Event};

/// The whole report.
pub fn xml(tests: &[Test]) -> String {
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
    let mut suites: Vec<(&str, &str)> = Vec::new();
    for test in tests {
        let suite = (test.file.as_str(), test.program);
        if !suites.contains(&suite) {
            suites.push(suite);
        }
    }
    let written = writer
        .create_element("testsuites")
        .with_attributes(counts(tests.iter()).iter().map(|(k, v)| (*k, v.as_str())))
        .write_inner_content(|w| {
            for (file, program) in suites {
                let inside: Vec<&Test> = tests.iter().filter(|t| t.file == file && t.program == program).collect();
                let name = format!("{file} ({program})");
                w.create_element("testsuite")
                    .with_attribute(("name", name.as_str()))
                    .with_attributes(counts(inside.iter().copied()).iter().map(|(k, v)| (*k, v.as_str())))
                    .write_inner_content(|w| inside.iter().try_for_each(|test| case(w, test, &name)))?;
            }
            Ok(())
        });
    written.expect("writing to memory succeeds");
    let body = String::from_utf8(writer.into_inner()).expect("XML is written as UTF-8");
    format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{body}\n")
}

fn counts<'a>(tests: impl Iterator<Item = &'a Test> + Clone) -> [(&'static str, String); 3] {
    let failures = tests.clone().filter(|t| t.failure.is_some()).count();
    let time = time(tests.clone().map(|t| t.milliseconds).sum());
    [("tests", tests.count().to_string()), ("failures", failures.to_string()), ("time", time)]
}

fn case(w: &mut Writer<Vec<u8>>, test: &Test, suite: &str) -> std::io::Result<()> {
    let time = time(test.milliseconds);
    let element = w
        .create_element("testcase")
        .with_attribute(("name", clean(&test.scenario).as_str()))
        .with_attribute(("classname", suite))
        .with_attribute(("file", test.file.as_str()))
        .with_attribute(("time", time.as_str()));
    let Some(failure) = &test.failure else {
        element.write_empty()?;
        return Ok(());
    };
    let message = clean(&format!("line {}: {}: {}", failure.line, failure.step, failure.message));
    element.write_inner_content(|w| {
        w.create_element("failure")
            .with_attribute(("message", message.as_str()))
            .with_attribute(("type", "expectation"))
            .write_inner_content(|w| w.write_event(Event::Text(BytesText::new(&clean(&failure.human())))))?;
        Ok(())
    })?;
    Ok(())
}

fn time(milliseconds: u64) -> String {
    format!("{}.{:03}", milliseconds / 1000, milliseconds % 1000)
}

/// Without control characters, which XML cannot hold at all.
fn clean(text: &str) -> String {
    text.chars().map(|c| if c.is_control() && c != '\n' { ' ' } else { c }).collect()
}
