//! The option that names an estimator.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use phugoid_identification::method::Method;

/// Accepts the name of an estimator; the help text lists all names, each with a short description.
pub(super) fn method() -> impl TypedValueParser<Value = Method> {
    let named = Method::ALL.iter().map(|method| PossibleValue::new(method.name()).help(method.description()));
    PossibleValuesParser::new(named).try_map(|name| name.parse::<Method>())
}

/// The same where the samples come one by one: the help text lists the methods that see no future. The others are known
/// too, so that the command can say why it refuses them.
pub(super) fn causal_method() -> impl TypedValueParser<Value = Method> {
    let named = Method::ALL
        .iter()
        .map(|method| PossibleValue::new(method.name()).help(method.description()).hide(method.is_batch()));
    PossibleValuesParser::new(named).try_map(|name| name.parse::<Method>())
}
