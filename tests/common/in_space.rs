//! The names of the block in space for tests of both units.

/// Returns the like of a variable of the planar unit here.
pub fn name(planar: &str) -> &str {
    match planar {
        "theta" => "tilt_x",
        "theta_dot" => "omega_y",
        "theta_ddot" => "omega_y_dot",
        "initial.theta" => "initial.tilt_x",
        "peak.theta" => "peak.tilt",
        "regime" => "touching",
        "uplift_L" => "uplift_SW",
        "uplift_R" => "uplift_SE",
        "record.horizontal" => "record.x",
        "record.vertical" => "record.z",
        "record.horizontal_unit" => "record.x_unit",
        "record.horizontal_samples" => "record.x_samples",
        "record.vertical_samples" => "record.z_samples",
        "record.PGA" => "record.PGA_x",
        "events.impacts" => "events.landings",
        "events.liftoffs" => "events.lift_offs",
        // A parameter that is 0 at the start, and changes the motion.
        "epsilon" => "eccentricity_y",
        other => other,
    }
}
