# What each Debian package installs (docs/packages.md): one component for one package. The preset
# `vehicle` builds the programs of the package bevloc, the preset `release` those of the others.
include(GNUInstallDirs)
set(BEVLOC_DATA_DIR ${CMAKE_INSTALL_DATADIR}/bevloc)

if(NOT BEVLOC_SIMULATION)
  install(TARGETS bevlocd COMPONENT bevloc)
  install(FILES systemd/bevlocd.service DESTINATION lib/systemd/system COMPONENT bevloc)
  install(FILES systemd/sysusers.d/bevloc.conf DESTINATION lib/sysusers.d COMPONENT bevloc)
  install(FILES systemd/network/80-bevloc-can.link systemd/network/80-bevloc-can.network
                systemd/udev/60-bevloc.rules
          DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT bevloc)
  install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT bevloc
          FILES_MATCHING PATTERN "*.md" PATTERN "images" EXCLUDE PATTERN "decisions" EXCLUDE)
  install(DIRECTORY config/ DESTINATION ${BEVLOC_DATA_DIR}/config COMPONENT bevloc
          FILES_MATCHING PATTERN "rig_*.yaml")
  install(FILES models/nano.onnx DESTINATION ${BEVLOC_DATA_DIR}/models COMPONENT bevloc-models)
  install(FILES models/README.md DESTINATION share/doc/bevloc-models COMPONENT bevloc-models)
  return()
endif()

# The programs with the simulator have the names of the ones without, so they lie in a folder of
# their own.
install(TARGETS bevloc bevlocd DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/bevloc-sim
        COMPONENT bevloc-sim)
install(FILES config/demo.yaml DESTINATION ${BEVLOC_DATA_DIR}/config COMPONENT bevloc-sim)

install(TARGETS bevloc-compliance bevloc_convert_map COMPONENT bevloc-dev)
install(FILES can/bevloc.dbc DESTINATION ${BEVLOC_DATA_DIR} COMPONENT bevloc-dev)
