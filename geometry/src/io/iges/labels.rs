//! Names that a file gives to its entities: properties, else labels.

use super::super::error::Fail;
use super::Model;
use super::directory::Entry;
use super::groups::members;
use super::params::Params;

/// Name of an entity: its property 406 form 15 if there is one, or else its label. After an entity's own `values` values
/// stand two lists of pointers, each with its length in front: associativities, then properties.
pub fn name_of(model: &Model, entry: &Entry, values: usize) -> Result<Option<String>, Fail> {
    let params = model.params(entry)?;
    if let Some(name) = property_name(model, &params, values)? {
        return Ok(Some(name));
    }
    Ok(label(entry))
}

/// The name among the properties that follow an entity's own values.
fn property_name(model: &Model, params: &Params, values: usize) -> Result<Option<String>, Fail> {
    if params.len() <= values {
        return Ok(None);
    }
    let skip = params.count(values, "a number of associativity pointers")?;
    let at = values.saturating_add(skip).saturating_add(1);
    if params.len() <= at {
        return Ok(None);
    }
    for index in members(model, params, at, "a property")? {
        let property = &model.entries[index];
        if property.type_number == 406 && property.form == 15 {
            let params = model.params(property)?;
            if let Some(name) = params.string(2, "a name")? {
                return Ok(Some(name.trim().to_owned()));
            }
        }
    }
    Ok(None)
}

/// The label of an entity, if it has one.
pub fn label(entry: &Entry) -> Option<String> {
    (!entry.label.is_empty()).then(|| entry.label.clone())
}
