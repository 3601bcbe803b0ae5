//! Rules about the source tree, each a table and one test that names file, line and rule.

mod assertions;
mod documents;
mod imports;
mod kinds;
mod places;
mod prose;
mod purity;
mod texts;
pub mod tree;
