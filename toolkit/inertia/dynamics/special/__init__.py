"""Where scipy loses digits: elliptic functions from the complementary parameter, double-double numbers."""
