//! `kirigami studio`

use crate::ui::{interrupt, with_unit};
use anyhow::Result;
use clap::Args;
use rand::random;
use scene::{Level, Scene};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};
use studio::{engine::Engine, event::Post, project::Project, server::StudioServer, static_page};

/// Draw a sheet in the browser, watch it open, and design it
///
/// Serves one page on 127.0.0.1, to this computer alone and without a network, and opens the
/// browser. Ctrl-C ends it. A scene or a run is copied to a folder below runs/studio; everything
/// that the page does is a scene there, which `kirigami design` repeats. docs/STUDIO.md is the
/// tutorial. Examples: kirigami studio; kirigami studio configs/scenes/a4-plate.toml; kirigami
/// studio runs/studio/a4-plate
#[derive(Args)]
pub struct StudioCommand {
    /// Scene (TOML), run folder, or folder of a sheet in the studio, whose scene is changed in
    /// place [default: a new sheet]
    #[arg(value_name = "SCENE")]
    scene: Option<PathBuf>,
    /// The level, instead of the scene's: how much of the hinges is modelled; see `kirigami levels`
    #[arg(long, value_name = "LEVEL", value_parser = with_unit::level_up_to(Level::Fine), requires = "scene")]
    level: Option<Level>,
    /// Folder of the folders of new sheets
    #[arg(long, value_name = "FOLDER", default_value = "runs/studio")]
    folder: PathBuf,
    /// Write the studio into this new folder as a page for any web server, and end: it runs in the
    /// browser, and sends nothing. It needs the module that `make page` compiles
    #[arg(long, value_name = "FOLDER", exclusive = true)]
    page: Option<PathBuf>,
    /// Port on 127.0.0.1 [default: a free one]
    #[arg(long, value_name = "PORT", default_value_t = 0, hide_default_value = true)]
    port: u16,
    /// Print the address, and open no browser
    #[arg(long)]
    no_browser: bool,
}

impl StudioCommand {
    /// A project for a scene, at the level of the command line.
    fn opened(&self, path: &Path, projects: &Path) -> Result<(Project, Scene)> {
        let (project, scene) = Project::open(path, projects)?;
        let Some(level) = self.level else {
            return Ok((project, scene));
        };
        let scene = scene.at_level(level)?;
        project.save(&scene)?;
        Ok((project, scene))
    }

    pub(crate) fn run(&self) -> Result<()> {
        if let Some(folder) = &self.page {
            return static_page::write(folder);
        }
        let projects = std::path::absolute(&self.folder)?;
        let opened = self.scene.as_deref();
        let opened = opened.map(|path| self.opened(path, &projects)).transpose()?;
        let stop = interrupt::stop_flag()?;
        let post = Arc::new(Post::default());
        let studio = Arc::new(StudioServer::listen(
            self.port,
            format!("{:032x}", random::<u128>()),
            Arc::clone(&post),
        )?);
        let engine =
            Arc::new(Engine::start(opened, projects, Arc::new(move |event| post.deliver(event)))?);
        let address = studio.address();
        println!("kirigami studio: {address}\nCtrl-C ends it");
        if !self.no_browser
            && let Err(error) = open::that_detached(&address)
        {
            eprintln!("cannot open a browser ({error}): open the address above");
        }
        let served = studio.serve(&engine, stop);
        engine.end();
        served
    }
}
