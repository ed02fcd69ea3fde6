//! Hosts that share the folder of a campaign.

/// The name of this host, by which the runs that share a folder are distinguished. `KIRIGAMI_HOST`
/// replaces it where host names are not unique.
pub(crate) fn host() -> String {
    let name = std::env::var_os("KIRIGAMI_HOST").or_else(|| nix::unistd::gethostname().ok());
    let name = name.unwrap_or_else(|| "localhost".into());
    name.to_string_lossy().replace('/', "_")
}
