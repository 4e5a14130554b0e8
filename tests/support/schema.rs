//! Checks against the schema of PLCopen TC6 v2.01, where it and `xmllint` are at hand.

use chartwright::emit::Dialect;
use std::path::PathBuf;
use std::process::Command;

fn schema() -> Option<PathBuf> {
    let shared = std::env::var_os("CHARTWRIGHT_SHARED")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    let path = shared.join("schema/tc6_xml_v201.xsd");
    if !path.is_file() {
        eprintln!("SKIPPED: no schema check, there is no {}", path.display());
        return None;
    }
    if Command::new("xmllint").arg("--version").output().is_err() {
        eprintln!("SKIPPED: no schema check, xmllint is not installed");
        return None;
    }
    Some(path)
}

/// Fails unless `xml` is valid; `name` tells files of parallel tests apart.
pub fn assert_valid(name: &str, xml: &str, dialect: Dialect) {
    let Some(schema) = schema() else { return };
    let xml = match dialect {
        Dialect::Beremiz => xml.to_owned(),
        // The versions differ in their name only.
        Dialect::Codesys => xml.replace("http://www.plcopen.org/xml/tc6_0200", "http://www.plcopen.org/xml/tc6_0201"),
    };
    let file = std::env::temp_dir().join(format!("chartwright-{}-{name}-{dialect:?}.xml", std::process::id()));
    std::fs::write(&file, xml).expect("the temporary folder takes a file");
    let output = Command::new("xmllint").args(["--noout", "--schema"]).arg(&schema).arg(&file).output();
    let output = output.expect("xmllint runs");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{name} is not valid in {dialect:?}:\n{said}");
    std::fs::remove_file(&file).expect("the file is there");
}
