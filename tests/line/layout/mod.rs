//! Rules about the source tree, each a table and one test that names file, line and rule.

mod documents;
mod imports;
mod places;
mod purity;
mod tree;
