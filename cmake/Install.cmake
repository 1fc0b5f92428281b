# What each Debian package installs (docs/packages.md): one component for one package. The preset
# `vehicle` builds the programs of the package bevloc, the preset `release` those of the others.
include(GNUInstallDirs)
set(BEVLOC_DATA_DIR ${CMAKE_INSTALL_DATADIR}/bevloc)

if(NOT BEVLOC_SIMULATION)
  # Manual pages and schemas, which the command bevloc writes.
  set(said ${CMAKE_BINARY_DIR}/said)
  add_custom_command(
    OUTPUT ${said}/bevloc.1 ${said}/bevlocd.8 ${said}/bevloc.yaml.5 ${said}/bevlocd.schema.json
           ${said}/rig.schema.json
    COMMAND ${CMAKE_COMMAND} -E make_directory ${said}
    COMMAND bevloc manual --out ${said}
    COMMAND bevloc schema > ${said}/bevlocd.schema.json
    COMMAND bevloc schema --rig > ${said}/rig.schema.json
    DEPENDS bevloc VERBATIM)
  add_custom_target(bevloc_said ALL DEPENDS ${said}/bevloc.1)
  install(FILES ${said}/bevloc.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT bevloc)
  install(FILES ${said}/bevloc.yaml.5 DESTINATION ${CMAKE_INSTALL_MANDIR}/man5 COMPONENT bevloc)
  install(FILES ${said}/bevlocd.8 DESTINATION ${CMAKE_INSTALL_MANDIR}/man8 COMPONENT bevloc)
  # bash looks for a file with the name of the program.
  foreach(program bevloc bevlocd)
    install(FILES command/manual/installed/bevloc RENAME ${program}
            DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT bevloc)
  endforeach()
  install(FILES command/manual/installed/_bevloc
          DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT bevloc)
  install(FILES ${said}/bevlocd.schema.json ${said}/rig.schema.json
          DESTINATION ${BEVLOC_DATA_DIR}/schema COMPONENT bevloc)

  install(TARGETS bevlocd bevloc COMPONENT bevloc)
  install(FILES systemd/bevlocd.service DESTINATION lib/systemd/system COMPONENT bevloc)
  install(FILES systemd/sysusers.d/bevloc.conf DESTINATION lib/sysusers.d COMPONENT bevloc)
  install(FILES systemd/network/80-bevloc-can.link systemd/network/80-bevloc-can.network
                systemd/udev/60-bevloc.rules systemd/live.conf systemd/gnss.conf systemd/clock.conf
          DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT bevloc)
  # The pages link to each other, so they lie in the folders of the source tree. script/try-packages
  # checks the links.
  install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT bevloc
          FILES_MATCHING PATTERN "*.md" PATTERN "*.json" PATTERN "images" EXCLUDE)
  install(FILES README.md CHANGELOG.md CONTRIBUTING.md SECURITY.md
          DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT bevloc)
  install(FILES models/README.md models/nano_results.json
          DESTINATION ${CMAKE_INSTALL_DOCDIR}/models COMPONENT bevloc)
  install(FILES training/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/training COMPONENT bevloc)
  install(FILES can/bevloc.dbc DESTINATION ${CMAKE_INSTALL_DOCDIR}/can COMPONENT bevloc)
  install(DIRECTORY config/ DESTINATION ${BEVLOC_DATA_DIR}/config COMPONENT bevloc
          FILES_MATCHING PATTERN "rig_*.yaml")
  install(FILES models/nano.onnx models/small-lut.onnx
          DESTINATION ${BEVLOC_DATA_DIR}/models COMPONENT bevloc-models)
  install(FILES models/README.md DESTINATION share/doc/bevloc-models COMPONENT bevloc-models)
  return()
endif()

# The programs with the simulator have the names of the ones without, so they lie in a folder of
# their own.
install(TARGETS bevloc bevlocd DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/bevloc-sim
        COMPONENT bevloc-sim)
install(FILES config/demo.yaml config/demo_own_bus.yaml config/vehicle_demo.dbc
              config/calibration.yaml
        DESTINATION ${BEVLOC_DATA_DIR}/config COMPONENT bevloc-sim)
install(FILES evaluation/campaign/matches.csv
        DESTINATION ${BEVLOC_DATA_DIR}/evaluation/campaign COMPONENT bevloc-sim)

install(TARGETS bevloc-compliance bevloc_convert_map bevloc_dbc COMPONENT bevloc-dev)
install(FILES can/bevloc.dbc DESTINATION ${BEVLOC_DATA_DIR} COMPONENT bevloc-dev)
install(DIRECTORY can/consumer/ DESTINATION ${BEVLOC_DATA_DIR}/consumer COMPONENT bevloc-dev
        FILES_MATCHING PATTERN "*.h" PATTERN "*.hpp" PATTERN "*.py" PATTERN "*.c" PATTERN "*.cpp"
        PATTERN "golden*" PATTERN "__pycache__" EXCLUDE)
