//! What a material means for the ligaments of an intended sheet, before windows are solved.
//!
//! Estimates for a ligament of width w in a sheet of thickness t (sections 4.2 and 5.1):
//!
//! | quantity | value |
//! |---|---|
//! | film: strain at which it buckles | (t / w)^2 / 2, at the rotation t / w |
//! | film: rotation at which a fold as long as the ligament is wide yields at its surface | 2 w / t times the yield strain |
//! | rotation at which the most strained 1 % tears, at the tip | fracture strain and yield strain over the strain at the tip |
//!
//! docs/MATERIALS.md has the windows that the strain at the tip comes from.

use crate::calibration::CALIBRATION;
use hinge::{Regime, SheetMaterial};
use serde::Serialize;
use support::document::Document;
use support::severity::{Finding, Severity};
use support::table::{Cell, Table};
use support::{Extremes, Joined};

/// The minimum and maximum ligament width (mm) for which there are hinge data, in a sheet of the given
/// thickness (mm).
pub fn usual_widths(thickness: f64, regime: Regime) -> [f64; 2] {
    CALIBRATION.of(regime).slenderness.value.map(|ratio| ratio * thickness)
}

/// Estimates for one ligament width.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LigamentEstimate {
    /// Ligament width (mm).
    pub w_lig: f64,
    /// Width over thickness.
    pub slenderness: f64,
    /// Rotation at which the ligament buckles (deg); `None` for a plate.
    pub buckles_at_deg: Option<f64>,
    /// Rotation at which the surface of the fold yields (deg); `None` for a plate.
    pub yields_at_deg: Option<f64>,
    /// The least and the largest rotation at which the tip tears, at most a half turn (deg).
    pub tears_at_deg: [f64; 2],
}

/// All estimates and findings.
#[derive(Debug, Serialize)]
pub struct MaterialCheck {
    /// Hash of the law.
    pub law_hash: String,
    /// Yield stress over Young's modulus.
    pub yield_strain: f64,
    /// Estimates at the minimum and the maximum ligament width.
    pub ligaments: Vec<LigamentEstimate>,
    /// The most severe first. A note is a fact, a warning is to be checked before hours are spent,
    /// an error excludes the use.
    pub verdicts: Vec<Finding>,
}

/// Limit of an opening (deg).
const HALF_TURN: f64 = 180.0;

/// Maximum of Young's modulus over density of plastics without fibres and of papers (MPa m^3/kg);
/// paper has up to 12.
const STIFFEST_PLASTIC: f64 = 12.0;
impl MaterialCheck {
    /// Checks a valid material for positive ligament widths (mm), from a minimum to a maximum.
    pub fn new(material: &SheetMaterial, [min, max]: [f64; 2]) -> Self {
        let estimate = |w_lig| LigamentEstimate::new(material, w_lig);
        let mut ligaments = vec![estimate(min)];
        ligaments.extend((max > min).then(|| estimate(max)));
        let mut verdicts = law(material);
        verdicts.extend(stiffness(material));
        verdicts.extend(buckling(material, &ligaments[0]));
        verdicts.extend(slenderness(&ligaments));
        verdicts.push(tearing(material, &ligaments[0]));
        verdicts.sort_by_key(|verdict| std::cmp::Reverse(verdict.severity));
        Self {
            law_hash: material.law_hash(),
            yield_strain: yield_strain(material),
            ligaments,
            verdicts,
        }
    }

    /// The law, the estimates and the verdicts of the material that was checked.
    pub fn document(&self, material: &SheetMaterial) -> Document {
        let SheetMaterial { name, thickness, young, poisson, plastic, .. } = material;
        let mut page = Document::default();
        page.text(format!("{name}, {thickness} mm (law {})", self.law_hash));
        page.text(format!(
            "*ELASTIC as the window solver reads it: E = {young} MPa, nu = {poisson}\n*PLASTIC:"
        ));
        let mut rows = Table::new(["row", "true stress, MPa", "plastic strain", "slope, MPa"]);
        for (index, [stress, strain]) in plastic.iter().enumerate() {
            let slope = match plastic.get(index + 1) {
                Some([next, to]) => format!("{:.0}", (next - stress) / (to - strain)),
                None => "constant".into(),
            };
            rows.row([(index + 1).to_string(), stress.to_string(), strain.to_string(), slope]);
        }
        page.table(rows);
        let mut widths =
            Table::new(["w_lig\nmm", "w/t", "buckles at\ndeg", "surface yields at\ndeg", "tears"]);
        for it in &self.ligaments {
            widths.row([
                Cell::fixed(it.w_lig, 2),
                Cell::fixed(it.slenderness, 2),
                Cell::fixed(it.buckles_at_deg, 2),
                Cell::fixed(it.yields_at_deg, 1),
                Cell::text(it.tears()),
            ]);
        }
        page.table(widths);
        page.text(self.verdicts.iter().map(Finding::to_string).joined("\n"));
        page
    }

    /// What excludes the use.
    pub fn errors(&self) -> impl Iterator<Item = &Finding> {
        self.verdicts.iter().filter(|verdict| verdict.severity == Severity::Error)
    }
}

impl LigamentEstimate {
    fn new(material: &SheetMaterial, w_lig: f64) -> Self {
        let slenderness = w_lig / material.thickness;
        let regime = Regime::of(slenderness);
        let of_film = |angle: f64| (regime == Regime::Film).then_some(angle.to_degrees());
        // The fracture strain is plastic.
        let tears = material.fracture_strain + yield_strain(material);
        let [least, most] = CALIBRATION.of(regime).tip_strain.value.map(|strain| tears / strain);
        Self {
            w_lig,
            slenderness,
            buckles_at_deg: of_film(slenderness.recip()),
            yields_at_deg: of_film(2.0 * slenderness * yield_strain(material)),
            tears_at_deg: [most, least].map(|angle| angle.to_degrees().min(HALF_TURN)),
        }
    }

    /// The rotations at which the tip tears, in words.
    fn tears(&self) -> String {
        let [from, to] = self.tears_at_deg;
        if from >= HALF_TURN {
            "at no opening".to_owned()
        } else if to >= HALF_TURN {
            format!("at {from:.0} deg or more")
        } else {
            format!("at {from:.0} to {to:.0} deg")
        }
    }

    fn regime(&self) -> Regime {
        Regime::of(self.slenderness)
    }
}

fn yield_strain(material: &SheetMaterial) -> f64 {
    material.plastic[0][0] / material.young
}

/// Yield, hardening, softening, and the end of the table.
fn law(material: &SheetMaterial) -> Vec<Finding> {
    let SheetMaterial { plastic, young, fracture_strain, .. } = material;
    let [yields, _] = plastic[0];
    let [stress, strain] = plastic[plastic.len() - 1];
    let hardens = match plastic.len() {
        1 => "does not harden".to_owned(),
        _ => {
            let modulus = (stress - yields) / strain / young;
            format!(
                "has {stress} MPa at the plastic strain {strain}: a mean hardening modulus of {modulus:.4} E"
            )
        }
    };
    let percent = 100.0 * yield_strain(material);
    let yields =
        format!("the material yields at {yields} MPa, a strain of {percent:.2} %, and {hardens}");
    let mut verdicts = vec![Severity::Note.finding(yields)];
    let slope = |pair: &[[f64; 2]]| (pair[1][0] - pair[0][0]) / (pair[1][1] - pair[0][1]);
    let drop = plastic.windows(2).smallest_by(|pair| slope(pair));
    if let Some(&[[from, start], [to, end]]) =
        drop.and_then(|pair| <&[[f64; 2]; 2]>::try_from(pair).ok())
        && to < from
    {
        let steepest = CALIBRATION.steepest_drop.value;
        let steepness = (from - to) / (end - start) / young;
        let fall = format!(
            "the table falls from {from} to {to} MPa between the plastic strains {start} and {end}"
        );
        verdicts.push(if steepness > steepest {
            let steep = format!(
                "{fall}, by {steepness:.3} E: above {steepest} E coarse meshes diverge; spread the fall over a longer \
                 strain"
            );
            Severity::Warning.finding(steep)
        } else {
            Severity::Note.finding(format!("{fall}: the material softens there"))
        });
    }
    if *fracture_strain > 1.05 * strain {
        let held = format!(
            "between the last row, at {strain}, and the fracture strain {fracture_strain} the window solver holds the \
             stress constant at {stress} MPa"
        );
        verdicts.push(Severity::Note.finding(held));
    }
    verdicts
}

/// Whether a material with the density of a plastic has the modulus of a plastic.
fn stiffness(material: &SheetMaterial) -> Option<Finding> {
    let [young, density] = [material.young, material.density_kg_m3];
    (!material.is_metal() && young > STIFFEST_PLASTIC * density).then(|| {
        let message = format!(
            "young = {young} MPa is {:.0} MPa for each kg/m^3 of the density {density}: plastics without fibres have less than \
             {STIFFEST_PLASTIC}; in a tensile test check width, thickness, gauge length and units",
            young / density
        );
        Severity::Warning.finding(message)
    })
}

/// Whether the narrowest ligament of a film buckles before it yields in its plane.
fn buckling(material: &SheetMaterial, narrowest: &LigamentEstimate) -> Option<Finding> {
    let yields = yield_strain(material);
    let buckles = 0.5 / narrowest.slenderness.powi(2);
    (narrowest.regime() == Regime::Film && buckles >= yields).then(|| {
        let width = material.thickness / (2.0 * yields).sqrt();
        let message = format!(
            "ligaments narrower than {width:.1} mm yield in their plane, at a strain of {yields:.4}, before they buckle, at \
             {buckles:.4} for {} mm: their windows converge in small increments or not at all",
            narrowest.w_lig
        );
        Severity::Warning.finding(message)
    })
}

/// Width over thickness against the ranges for which hinge data exist.
fn slenderness(ligaments: &[LigamentEstimate]) -> Option<Finding> {
    // Rounding of a width given as a multiple of the thickness.
    let slack = 1e-9;
    let outside = ligaments.iter().filter(|ligament| {
        let [least, most] = CALIBRATION.of(ligament.regime()).slenderness.value;
        !(least * (1.0 - slack)..=most * (1.0 + slack)).contains(&ligament.slenderness)
    });
    let found: Vec<String> = outside
        .map(|ligament| {
            let LigamentEstimate { w_lig, slenderness, .. } = ligament;
            format!("{w_lig} mm is {slenderness:.1} thicknesses")
        })
        .collect();
    (!found.is_empty()).then(|| {
        let [[narrow, wide], [least, most]] = [Regime::Plate, Regime::Film].map(|regime| CALIBRATION.of(regime).slenderness.value);
        let message = format!(
            "a ligament of {}: the shipped hinge data cover {narrow} to {wide} of plates and {least} to {most} of films, so try a \
             window (kirigami solve) before a campaign",
            found.join(", of ")
        );
        Severity::Warning.finding(message)
    })
}

/// The strain at the tip against the fracture strain.
fn tearing(material: &SheetMaterial, ligament: &LigamentEstimate) -> Finding {
    let regime = ligament.regime();
    let ([least, most], [from, to]) =
        (CALIBRATION.of(regime).tip_strain.value, ligament.tears_at_deg);
    let opening = CALIBRATION.of(regime).opening.value;
    let (severity, tears) = if to < opening {
        (Severity::Error, "tears")
    } else if from < opening {
        (Severity::Warning, "may tear")
    } else {
        (Severity::Note, "does not tear")
    };
    severity.finding(format!(
        "a {regime} that opens by {opening:.0} deg, as most do, {tears}: the tip of a ligament strains by {least} to {most} for each rad, \
         and with the fracture strain {} it tears {}",
        material.fracture_strain,
        ligament.tears()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film() -> SheetMaterial {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        let film = root.join("../configs/materials/pet-0.5mm.toml");
        SheetMaterial::load(&film).unwrap()
    }

    const PAPER: [f64; 2] = [18.0, 18.0];

    fn check(change: impl Fn(&mut SheetMaterial), w_lig: [f64; 2]) -> MaterialCheck {
        let mut material = film();
        change(&mut material);
        MaterialCheck::new(&material, w_lig)
    }

    /// Whether a verdict of the severity contains the text.
    fn says(check: &MaterialCheck, severity: Severity, text: &str) -> bool {
        let mut verdicts = check.verdicts.iter();
        verdicts.any(|found| found.severity == severity && found.message.contains(text))
    }

    #[test]
    fn the_film_of_the_paper_has_no_warning() {
        let check = check(|_| {}, PAPER);
        let mut verdicts = check.verdicts.iter();
        let notes = verdicts.all(|found| found.severity == Severity::Note);
        assert!(notes, "{check:?}");
        let [ligament] = check.ligaments[..] else { panic!("{check:?}") };
        assert_eq!(ligament.slenderness, 36.0);
        // The surface strain at the rotation of yield is the yield strain.
        let at_yield = 0.5 * ligament.yields_at_deg.unwrap().to_radians() / 36.0;
        assert!((at_yield - 44.0 / 3000.0).abs() < 1e-12);
    }

    #[test]
    fn every_limit_has_its_verdict() {
        let with = |change: fn(&mut SheetMaterial)| check(change, PAPER);
        let soft = check(|material| material.plastic[0][0] = 30.0, [3.0, 30.0]);
        for (check, severity, text) in [
            (&with(|it| it.fracture_strain = 0.03), Severity::Error, "tears"),
            (&with(|it| it.fracture_strain = 0.2), Severity::Warning, "may tear"),
            (&with(|it| it.young = 30e3), Severity::Warning, "22 MPa for each kg/m^3"),
            (&with(|it| it.plastic[1][1] = 0.02), Severity::Warning, "coarse meshes diverge"),
            (&soft, Severity::Warning, "3 mm is 6.0 thicknesses, of 30 mm is 60.0"),
            (&soft, Severity::Warning, "before they buckle"),
            (&with(|it| it.fracture_strain = 3.0), Severity::Note, "constant at 200 MPa"),
        ] {
            assert!(says(check, severity, text), "{text}: {check:?}");
        }
    }

    #[test]
    fn the_ligament_of_a_plate_is_checked_as_one() {
        let check = check(|material| material.fracture_strain = 1.7, [0.15, 0.475]);
        let [ligament, _] = check.ligaments[..] else { panic!("{check:?}") };
        assert_eq!(ligament.buckles_at_deg, None);
        // The fracture strain 1.7 and the yield strain 44 / 3000 over 1.7 and over 0.4 for each
        // rad.
        assert!((ligament.tears_at_deg[0] - 57.7901).abs() < 1e-4);
        assert_eq!(ligament.tears_at_deg[1], 180.0);
        let notes = check.verdicts.iter().map(|found| found.severity);
        assert!(notes.eq([Severity::Note; 3]), "{check:?}");
    }
}
