//! `kirigami surrogate card`

use anyhow::Result;
use app::train::{UNSEEN, error_table};
use clap::Args;
use std::path::PathBuf;
use surrogate::{Surrogate, Teacher};

/// Print what weights were trained on, and their test errors
///
/// All numbers are in the JSON file next to the weights.
#[derive(Args)]
pub(crate) struct CardCommand {
    /// Weights (safetensors with their card)
    #[arg(value_name = "WEIGHTS")]
    weights: PathBuf,
}

impl CardCommand {
    pub(super) fn run(&self) -> Result<()> {
        let surrogate = Surrogate::load(&self.weights)?;
        let card = surrogate.card();
        println!("material {}, tier {}", card.material, card.tier);
        println!("database {}", card.dataset_hash);
        if let Some(base) = &card.fine_tuned_from {
            println!("fine-tuned from weights {base}");
        }
        for Teacher { weights, fine_tuned_from } in
            (card.distillation.iter()).flat_map(|distillation| &distillation.teachers)
        {
            let from = fine_tuned_from.as_deref().unwrap_or("not known");
            println!("distilled from weights {weights}, fine-tuned from {from}");
        }
        let hinge = card.hinge;
        let radius = match card.domain.holes {
            Some([least, most]) => format!("{least:.3} to {most:.3}"),
            None => hinge.fillet_ratio.to_string(),
        };
        println!(
            "hinges with fillet_ratio {radius}, kerf {} mm, r_win {} mm",
            hinge.kerf, hinge.r_win
        );
        let domain = &card.domain;
        let [eta_a, eta_s, theta] = domain.bounds();
        println!("training domain: ranges of the training states");
        let along = match domain.curve() {
            None => "a / w_lig".to_owned(),
            Some([first, second]) => {
                format!("a / w_lig beyond {first:.3} theta + {second:.3} theta^2")
            }
        };
        for (name, [min, max], scale) in [
            (along.as_str(), eta_a, 1.0),
            ("s / w_lig", eta_s, 1.0),
            ("theta (deg)", theta, 1f64.to_degrees()),
            ("w_lig (mm)", domain.w_lig, 1.0),
            ("alpha (deg)", domain.alpha, 1f64.to_degrees()),
        ] {
            println!("{name:12} from {:.3} to {:.3}", scale * min, scale * max);
        }
        println!("\n{}", error_table(&card.test_errors, UNSEEN));
        if let Some(check) = &card.visited {
            println!("\n{}", error_table(&check.errors, "states of hinges in designed sheets"));
        }
        Ok(())
    }
}
