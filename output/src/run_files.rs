//! The files of a run folder: `design` writes them from this table, `--restart` deletes by it,
//! docs/RUN-PAGE.md lists it.

use crate::{
    cut_file::{
        CutDrawing, CutLines, SheetDrawing, attachment_list, cut_list, cut_summary,
        deployed_panels, dxf, mark_errors, svg,
    },
    drawing,
    mounting_kit::{board, kit_pdf, steps_svg},
    report::{Report, Warning},
    run_page::run_page,
};
use analysis::{design_checks::CHECKS_FILE, mounting::Mounting};
use design::{
    objective::design_problem::Deployment,
    sheet::{cut_sheet::Sheet, kinematics::deployed_boundaries},
};
use scene::{Paper, Scene, design_run::Designed, placement::placed, run_inputs::STATE_FILE};
use std::io;
use support::Fault;

/// A file of a run folder.
pub struct RunFile {
    /// Its name.
    pub name: &'static str,
    /// What it holds.
    pub contents: &'static str,
    /// Who writes it.
    pub writer: Writer,
}

/// Who writes a file of a run.
pub enum Writer {
    /// The search, about once per second.
    Search,
    /// The commands that check a design.
    Checks,
    /// [`write_results`](crate::run_results::write_results), the text or bytes of this function; no
    /// file if that is `None`.
    Results(fn(&Results) -> io::Result<Option<Vec<u8>>>),
    /// The program, which draws the pictures of the results in pixels.
    Pictures,
}

/// What the results of a run are written from.
pub struct Results<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) designed: &'a Designed,
    pub(crate) cuts: &'a Result<CutLines, Fault>,
    pub(crate) report: &'a Report,
    /// The drawing of the sheet, if it is cut.
    pub(crate) sheet: Option<SheetDrawing>,
}

/// The files in the order in which they are written: the report first, so that there is never a cut
/// file without its report. The copies of the inputs, `scene.toml` and `inputs/`, are not among
/// them: a run may be started from them.
pub const RUN_FILES: [RunFile; 21] = [
    RunFile {
        name: STATE_FILE,
        contents: "state of the search, from which a stopped run continues, and the hashes of the copies of its inputs",
        writer: Writer::Search,
    },
    RunFile {
        name: CHECKS_FILE,
        contents: "what `kirigami levels` and `kirigami verify --sheet` found of the design, for report and page",
        writer: Writer::Checks,
    },
    result("report.json", "the report for programs", |run| {
        Ok(Some(serde_json::to_vec_pretty(run.report)?))
    }),
    result("report.txt", "the report as text", |run| {
        Ok(Some(run.report.document().to_string().into()))
    }),
    result(
        "run.html",
        "the run on one page: open it in a browser, click a hinge, move the slider",
        |run| Ok(Some(run_page(run.scene, run.designed, run.report).into())),
    ),
    result("cut.dxf", CUTS, |run| Ok(run.annotated().map(|drawing| dxf(&drawing).into()))),
    result("cut.svg", CUTS, |run| Ok(run.annotated().map(|drawing| svg(&drawing).into()))),
    result(
        "cut-list.csv",
        "hole diameter, ligament width and caliper width of every hinge",
        |run| Ok(run.cut().map(|(cuts, _)| cut_list(&run.best().sheet, cuts).into())),
    ),
    result(
        "attachments.csv",
        "where panels are held and pulled in the flat sheet, with holes and clips; of a mounted sheet also on the board, with forces",
        |run| {
            Ok(run
                .cut()
                .map(|(cuts, _)| attachment_list(cuts, run.report.mounting.as_ref()).into()))
        },
    ),
    result(
        "cut-summary.csv",
        "number of cuts, holes by diameter, length of cuts and idle travel",
        |run| Ok(run.cut().map(|(cuts, sheet)| cut_summary(cuts, &sheet.totals).into())),
    ),
    result("deployed.dxf", "the panels in the state that is compared with the target", |run| {
        Ok(run.cut().map(|_| {
            let Deployment { sheet, .. } = run.best();
            let configuration = placed(run.scene, sheet, &run.best().final_step().configuration);
            dxf(&deployed_panels(&deployed_boundaries(sheet, &configuration))).into()
        }))
    }),
    result(
        "mount.pdf",
        "what to buy, the steps in which a mounted sheet is opened, and the board at 1:1, on A4 and on one page",
        |run| {
            let pdf = run.mounted().map(|(sheet, mounting)| {
                let title = &run.scene.config.title;
                kit_pdf(title, sheet, mounting, Paper::A4).map_err(io::Error::other)
            });
            pdf.transpose()
        },
    ),
    result("mount.dxf", "the board: crosses with their numbers, and the opened panels", |run| {
        Ok(run.mounted().map(|(sheet, mounting)| dxf(&board(sheet, mounting)).into()))
    }),
    result("mount.svg", "the steps in which a mounted sheet is opened", |run| {
        Ok(run.mounted().map(|(sheet, mounting)| steps_svg(sheet, mounting).into()))
    }),
    result("flat.svg", FLAT, |run| {
        let title = &run.scene.config.title;
        let picture = |cuts| drawing::flat(title, &run.best().sheet, cuts).into();
        Ok(run.cuts.as_ref().ok().map(picture))
    }),
    picture("flat.png", FLAT),
    result("deployed-start.svg", BEFORE, |run| {
        Ok(Some(run.picture(&run.designed.start.deployment)))
    }),
    picture("deployed-start.png", BEFORE),
    result("deployed.svg", AFTER, |run| Ok(Some(run.picture(run.best())))),
    picture("deployed.png", AFTER),
    picture(ANIMATION, "animation of the deployment"),
];

/// The name of the animation of the deployment.
pub const ANIMATION: &str = "deployment.png";

const CUTS: &str = "cuts in cutting order, 1:1 in mm; layers HOLES, ATTACHMENT_HOLES, CUT, OUTLINE, ATTACHMENTS, REGISTRATION, ANNOTATION";
const FLAT: &str = "the flat sheet with its cuts";
const BEFORE: &str = "the sheet in the state that is compared with the target, before the search";
const AFTER: &str = "the same after the search";

const fn result(
    name: &'static str,
    contents: &'static str,
    write: fn(&Results) -> io::Result<Option<Vec<u8>>>,
) -> RunFile {
    RunFile { name, contents, writer: Writer::Results(write) }
}

const fn picture(name: &'static str, contents: &'static str) -> RunFile {
    RunFile { name, contents, writer: Writer::Pictures }
}

impl Results<'_> {
    fn best(&self) -> &Deployment {
        &self.designed.best.deployment
    }

    /// Cut lines and drawing, if the sheet is cut.
    fn cut(&self) -> Option<(&CutLines, &SheetDrawing)> {
        self.cuts.as_ref().ok().zip(self.sheet.as_ref())
    }

    /// What a machine reads, with the errors of a design whose files were forced.
    fn annotated(&self) -> Option<CutDrawing> {
        let mut drawing = self.sheet.as_ref()?.annotated();
        let errors: Vec<String> = self.report.errors().map(Warning::to_string).collect();
        mark_errors(&mut drawing, &errors);
        Some(drawing)
    }

    /// The sheet, if it is cut, and how it is mounted.
    fn mounted(&self) -> Option<(&Sheet, &Mounting)> {
        self.cut()?;
        Some((&self.best().sheet, self.report.mounting.as_ref()?))
    }

    fn picture(&self, deployment: &Deployment) -> Vec<u8> {
        drawing::deployed(self.scene, deployment).into()
    }
}
