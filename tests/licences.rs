//! The licences of everything that is linked in, against the list in `deny.toml`.

use crate::support::models::repository;
use std::process::Command;

#[test]
fn every_dependency_has_an_allowed_licence() {
    let deny = std::fs::read_to_string(repository("deny.toml")).expect("deny.toml is there");
    let allowed: Vec<&str> = deny
        .lines()
        .find_map(|l| l.strip_prefix("allow = ["))
        .expect("deny.toml lists licences")
        .split('"')
        .filter(|s| s.starts_with(char::is_alphabetic))
        .collect();
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--locked"])
        .current_dir(repository("."))
        .output()
        .expect("cargo can be run");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).expect("metadata is JSON");
    let packages = metadata["packages"].as_array().expect("metadata lists packages");
    assert!(packages.len() > 20, "the list of packages is whole");
    for package in packages {
        let (name, licence) = (&package["name"], package["license"].as_str().unwrap_or("none"));
        // Each alternative is a conjunction; one alternative has to be allowed as a whole.
        let fits = licence
            .replace('/', " OR ")
            .split(" OR ")
            .any(|alternative| alternative.split(" AND ").all(|l| allowed.contains(&l.trim_matches(['(', ')', ' ']))));
        let grouped = licence
            .strip_prefix('(')
            .and_then(|l| l.split_once(") AND "))
            .is_some_and(|(any, rest)| any.split(" OR ").any(|l| allowed.contains(&l)) && allowed.contains(&rest));
        assert!(fits || grouped, "{name} is licensed {licence}");
    }
}
