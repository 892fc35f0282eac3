model Shaken "A block under a fifth of a second of ground acceleration each way, through the FMU's Model Exchange"
  // importFMU("target/release/RockingBlock.fmu") in OpenModelica makes RockingBlock_me_FMU.
  RockingBlock_me_FMU block;
  Modelica.Blocks.Sources.TimeTable ground(table = [0, 4; 0.2, 4; 0.2, -4; 0.4, -4; 0.4, 0; 10, 0]);
equation
  connect(ground.y, block.a_gx);
end Shaken;
