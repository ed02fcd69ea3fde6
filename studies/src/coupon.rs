//! `kirigami-studies coupon`: how often the quantities of coupons that are computed are within two standard errors.

use anyhow::Result;
use clap::Args;
use design::analysis::calibration::Quantity;
use design::analysis::coupon::{Specimen, specimens};
use design::analysis::simulated_coupon::SimulatedCoupon;
use design::scene::Scene;
use design::sheet::deviation::Deviation;
use kirigami::ui::progress::Progress;
use kirigami::ui::run_folder;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::path::PathBuf;
use support::statistics::{normal, root_mean_square};
use support::table::{Cell, Table};

/// Calibrate coupons with random kerf, thickness and stresses, read with random errors, and count what is within two standard errors
///
/// The deviations are drawn from what is known before a measurement. Prints and writes coupon.md. Example: kirigami-studies coupon
/// configs/scenes/a4-plate.toml --draws 100
#[derive(Args)]
pub struct CouponStudy {
    /// Scene of the sheet (TOML)
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// Number of coupons
    #[arg(long, value_name = "N", default_value_t = 100)]
    draws: usize,
    /// Standard error of a reading (% of the largest)
    #[arg(long, value_name = "PERCENT", default_value_t = 2.0)]
    reading_error: f64,
    /// Folder for the page
    #[arg(long, value_name = "FOLDER", default_value = "runs/study-coupon")]
    out: PathBuf,
}

/// What is found of a quantity.
struct Row {
    name: String,
    within: usize,
    draws: usize,
    /// Errors, and what the fits say they are.
    errors: Vec<f64>,
    stated: Vec<f64>,
    before: f64,
}

impl CouponStudy {
    pub fn run(&self) -> Result<()> {
        let _held = run_folder::hold(&self.out)?;
        let scene = Scene::read(&self.scene)?;
        let specimens = specimens(&scene, &self.out, &mut |_| ())?;
        let thickness = scene.material.thickness;
        let cases = [
            (
                "thickness measured by itself",
                &[Quantity::Kerf, Quantity::Stress][..],
            ),
            ("thickness fitted", &Quantity::ALL),
        ];
        let mut rows = Vec::new();
        for (name, quantities) in cases {
            rows.extend(self.case(name, quantities, &specimens, thickness)?);
        }
        let table = Table::new()
            .column("quantity", |row: &Row| Cell::text(&row.name))
            .column("within two standard errors", |row| {
                Cell::text(format!("{} of {}", row.within, row.draws))
            })
            .column("error, rms", |row| {
                Cell::fixed(root_mean_square(row.errors.iter().copied()), 4)
            })
            .column("stated, rms", |row| {
                Cell::fixed(root_mean_square(row.stated.iter().copied()), 4)
            })
            .column("known before", |row| Cell::fixed(row.before, 4));
        let page = format!(
            "# Coupons that are computed\n\n`{}`: {} coupons, kerf, thickness and stresses drawn from what is known before, readings to {} % \
             of the largest. kerf and thickness in mm, stress relative. `kirigami-studies coupon`.\n\n{}",
            self.scene.display(),
            self.draws,
            self.reading_error,
            table.markdown(&rows)
        );
        run_folder::write(&self.out, "coupon.md", &page)?;
        println!("{page}\nwritten to {}", self.out.display());
        Ok(())
    }

    fn case(
        &self,
        name: &str,
        quantities: &[Quantity],
        specimens: &[Specimen],
        thickness: f64,
    ) -> Result<Vec<Row>> {
        let row = |quantity: &Quantity| Row {
            name: format!("{}, {name}", quantity.name()),
            within: 0,
            draws: 0,
            errors: Vec::new(),
            stated: Vec::new(),
            before: quantity.guess(thickness),
        };
        let mut rows: Vec<Row> = quantities.iter().map(row).collect();
        let bar = Progress::new(self.draws, "coupons");
        for seed in 0..self.draws {
            let mut random = ChaCha8Rng::seed_from_u64(seed as u64);
            let cut = drawn(thickness, &mut random);
            let known = Deviation {
                thickness: if quantities.contains(&Quantity::Thickness) {
                    0.0
                } else {
                    cut.thickness
                },
                ..Deviation::default()
            };
            let coupon = SimulatedCoupon {
                specimens,
                cut: &cut,
                error: 0.01 * self.reading_error,
            };
            let found = coupon.calibrate(quantities, &known, |exact, sheet| {
                exact.with_errors(sheet, &mut random)
            })?;
            for (row, estimate) in std::iter::zip(&mut rows, &found.estimates) {
                let error = estimate.deviation - *estimate.quantity.of(&mut cut.clone());
                row.draws += 1;
                row.within += usize::from(error.abs() <= 2.0 * estimate.standard_error);
                row.errors.push(error);
                row.stated.push(estimate.standard_error);
            }
            bar.show(seed + 1, None, "");
        }
        bar.finish();
        Ok(rows)
    }
}

/// A sheet as it comes.
fn drawn(thickness: f64, random: &mut ChaCha8Rng) -> Deviation {
    let mut cut = Deviation::default();
    for quantity in Quantity::ALL {
        let size = normal([random.random(), random.random()]);
        *quantity.of(&mut cut) = quantity.guess(thickness) * size;
    }
    cut
}
