grain = "#eeeeee";
outline = "#a8a8a8";
classes = 12;
pale_r = 150; pale_g = 170; pale_b = 195;
dark_r = 8; dark_g = 24; dark_b = 58;
