//! PLCopen XML of projects built by hand: valid, well-formed, numbered and nested as IDEs want it.

use crate::support::{plc, schema};
use chartwright::emit::{Dialect, Header, plcopen};
use chartwright::ir::plc::Project;

const DIALECTS: [Dialect; 2] = [Dialect::Beremiz, Dialect::Codesys];

fn emit(project: &Project, dialect: Dialect) -> String {
    plcopen(project, dialect, &Header::default())
}

#[test]
fn the_sample_is_valid() {
    let project = plc::sample();
    for dialect in DIALECTS {
        let xml = emit(&project, dialect);
        if let Some(dir) = std::env::var_os("CHARTWRIGHT_DUMP") {
            std::fs::write(std::path::Path::new(&dir).join(format!("sample-{dialect:?}.xml")), &xml).unwrap();
        }
        schema::assert_valid("sample", &xml, dialect);
    }
}
