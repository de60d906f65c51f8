"""Methods that step a body's attitude and angular velocity, each an `Integrator` of the table in `methods`."""
