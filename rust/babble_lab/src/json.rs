//! What goes to a page as JSON.

use serde_json::json;

use crate::brain::{Brain, MapActivity};
use crate::command::Case;
use crate::expression::RuleExpression;
use crate::fault::Fault;
use crate::film::Film;
use crate::lesson::{Lesson, Progress};
use crate::record::Record;
use crate::registry::Registry;
use crate::scene::{Scene, Sight};
use crate::setup::Setup;
use crate::state::State;

/// Something that goes to a page. A page downloads the code: this crate is compiled for size, and a generic
/// function would be compiled by its caller.
pub trait ToJson {
    /// Its JSON.
    ///
    /// # Errors
    /// Never for numbers that are finite; the serializer's signature has it.
    fn to_json(&self) -> Result<String, Fault>;
}

macro_rules! to_json {
    ($($kind:ty),+) => {
        $(impl ToJson for $kind {
            fn to_json(&self) -> Result<String, Fault> {
                Ok(serde_json::to_string(self)?)
            }
        })+
    };
}

to_json!(
    Registry,
    Setup,
    State,
    Scene,
    Sight,
    Film,
    Case,
    Option<Brain>,
    MapActivity,
    [Lesson],
    Progress,
    Record,
    Fault
);

/// What is wrong with the expression of a rule, and before how many characters, as JSON; `null` if it can be
/// used.
///
/// # Errors
/// As [`ToJson::to_json`].
pub fn check_rule(rule: &str) -> Result<String, Fault> {
    let fault = RuleExpression::parse(rule).err();
    let told = fault.map(|fault| json!({ "problem": fault.problem, "at": fault.at }));
    Ok(serde_json::to_string(&told)?)
}
