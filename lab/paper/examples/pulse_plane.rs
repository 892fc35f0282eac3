//! Finds the one-sine pulses under which the paper's findings on Figures 6 and 7 hold.
//!
//! `cargo run --release -p paper-figures --example pulse_plane` writes docs/pictures/pulse_plane.png and prints the number of pulses of
//! each kind.

use paper_figures::plane::{BOUNDS, Grid, picture};
use rocking_charts::picture::PictureFormat;
use rocking_studies::output::runner;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let grid = Grid::FULL;
    let points = runner::pool(None)?.install(|| grid.responses())?;
    let rocking = points.iter().filter(|point| point.rigid.is_some_and(|peak| peak > 0.0)).count();
    println!("{} points; on the rigid base the block rocks and stands in {rocking}", points.len());
    let separated = points.iter().filter(|point| point.separates_without_restitution).count();
    println!("with epsilon = 0 it separates, at any eta from 20 to 800, in {separated}");
    println!("least ratio   points   of these with separation as eta grows   a_p/(g tan alpha)   omega_p/p");
    for bound in std::iter::once(0.0).chain(BOUNDS).chain([0.95]) {
        let there: Vec<u64> = (0..points.len() as u64)
            .filter(|&i| points[i as usize].least_ratio().is_some_and(|ratio| ratio >= bound))
            .collect();
        let separating = there.iter().filter(|&&i| points[i as usize].separates_as_eta_grows()).count();
        let range = |of: fn((f64, f64)) -> f64| {
            let values = || there.iter().map(|&i| of(grid.coordinates(i)));
            let (least, greatest) = (values().reduce(f64::min), values().reduce(f64::max));
            least.zip(greatest).map_or(String::new(), |(a, b)| format!("{a:.2} to {b:.2}"))
        };
        let (amplitudes, frequencies) = (range(|point| point.0), range(|point| point.1));
        println!("{bound:<14}{:<9}{separating:<40}{amplitudes:<20}{frequencies}", there.len());
    }
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    std::fs::write(folder.join("pulse_plane.png"), PictureFormat::Png.encode(&picture(&grid, &points)?)?)?;
    Ok(())
}
