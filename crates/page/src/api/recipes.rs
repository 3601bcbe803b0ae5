//! The routes of the recipes.

use super::{HTML, JSON, Member, Offer, may, must};
use crate::access::Role;
use crate::recipes;

const NAME: Member = must("name", "Name of the recipe.");

pub(super) fn offers() -> Vec<Offer> {
    vec![
        Offer::get("/api/recipes", JSON, "Every recipe with its newest revision, or what is wrong with it.", recipes::list),
        Offer::get(
            "/api/recipes/show",
            JSON,
            "A revision: every key with form, unit, range and value.",
            recipes::show,
        )
        .with(&[NAME, may("revision", "Number of an earlier one, from 1; the newest without it.")]),
        Offer::get("/api/recipes/card", HTML, "Operation process card for A4.", recipes::card)
            .with(&[NAME, may("lang", "`zh` (without it) or `en`.")]),
        Offer::post(
            "/api/recipes/revise",
            "The next revision of a recipe, in force from the next run on; 400 with `key`, `found` and `expected` for a value \
             that is refused, 409 where another revision came meanwhile.",
            recipes::revise,
        )
        .with(&[
            NAME,
            must("from", "Hash of the revision that was changed."),
            must("values", "New values by path of their key; null leaves a key out."),
        ])
        .needs(Role::Engineer),
    ]
}
