"""Methods that step a body's attitude and angular velocity, each behind `base.Integrator`."""
