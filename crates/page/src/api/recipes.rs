//! The routes of the recipes.

use super::{HTML, JSON, Member, Route, may, must};
use crate::access::Role;
use crate::recipes;

const NAME: Member = must("name", "Name of the recipe.");

pub(super) fn routes() -> Vec<Route> {
    vec![
        Route::get("/api/recipes", JSON, "Every recipe with its newest revision, or the error that keeps it from loading.", recipes::list),
        Route::get(
            "/api/recipes/show",
            JSON,
            "A revision: every key with form, unit, range and value.",
            recipes::show,
        )
        .with(&[NAME, may("revision", "Number of the revision, from 1; the newest without it.")]),
        Route::get("/api/recipes/card", HTML, "Operation process card for A4.", recipes::card)
            .with(&[NAME, may("lang", "`zh` (without it) or `en`.")]),
        Route::post(
            "/api/recipes/revise",
            "Saves the next revision of a recipe, which applies from the next run on; 400 with `key`, `found`, `expected` and \
             `requirement` \
             for a refused value, 409 when another revision came first.",
            recipes::revise,
        )
        .with(&[
            NAME,
            must("from", "Hash of the revision that the values change."),
            must("values", "New values by path of their key; null leaves a key out."),
        ])
        .needs(Role::Engineer),
    ]
}
