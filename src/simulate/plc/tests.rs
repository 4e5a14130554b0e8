//! What a scan does, rule by rule.
