//! `relayrig card`: prints the operation process card of a recipe.

use super::history::paper::PaperArgs;
use app::exit::Exit;
use clap::Args;
use config::{Folder, load_card, load_recipe};
use history::report::card::card;

/// Arguments of `card`.
#[derive(Debug, Args)]
#[command(after_help = "Example: relayrig card --recipe jzc-22f-012 --lang zh --out card.html")]
pub struct CardArgs {
    /// Recipe in config/recipes
    #[arg(long, value_name = "NAME")]
    recipe: String,
    #[command(flatten)]
    paper: PaperArgs,
}

/// Runs `relayrig card`.
///
/// # Errors
/// Fails when the configuration is faulty or the file cannot be written.
pub fn run(config: &Folder, args: &CardArgs) -> anyhow::Result<Exit> {
    let recipe = load_recipe(config, &args.recipe)?;
    let plant = load_card(config)?;
    let paper = args.paper.paper();
    args.paper.write(&card(&paper, &recipe, &plant))?;
    Ok(Exit::Done)
}
