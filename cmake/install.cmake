# SPDX-License-Identifier: Apache-2.0
# cmake --install build/release: programs, service, configuration, manual pages. Debian's packages are parts of the same tree
# (debian/*.install). What names a path is installed for the prefix of the configuration (-DCMAKE_INSTALL_PREFIX=/usr).
include(GNUInstallDirs)

set(dts_doc_dir ${CMAKE_INSTALL_DATAROOTDIR}/doc/dtsd)

# dts_install_for_prefix(FILE DIRECTORY): the file with the paths of this installation in the place of Debian's.
function(dts_install_for_prefix file directory)
  get_filename_component(name ${file} NAME)
  set_property(DIRECTORY ${CMAKE_SOURCE_DIR} APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} text)
  string(REPLACE "/usr/sbin/" "${CMAKE_INSTALL_FULL_SBINDIR}/" text "${text}")
  string(REPLACE "/usr/bin/" "${CMAKE_INSTALL_FULL_BINDIR}/" text "${text}")
  string(REPLACE " /etc/dts" " ${CMAKE_INSTALL_FULL_SYSCONFDIR}/dts" text "${text}")
  file(WRITE ${CMAKE_BINARY_DIR}/install/${name} "${text}")
  install(FILES ${CMAKE_BINARY_DIR}/install/${name} DESTINATION ${directory})
endfunction()

install(TARGETS dtsd dts-relay DESTINATION ${CMAKE_INSTALL_SBINDIR})
install(TARGETS dtsctl dts-gateway DESTINATION ${CMAKE_INSTALL_BINDIR})
if(TARGET dtslab)  # the thread sanitizer's build has none
  install(TARGETS dtslab DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

foreach(unit dtsd dts-relay dts-gateway)
  dts_install_for_prefix(${CMAKE_SOURCE_DIR}/systemd/${unit}.service lib/systemd/system)
endforeach()
install(FILES systemd/sysusers.d/dtsd.conf systemd/sysusers.d/dts-gateway.conf DESTINATION lib/sysusers.d)
dts_install_for_prefix(${CMAKE_SOURCE_DIR}/systemd/tmpfiles.d/dts-gateway.conf lib/tmpfiles.d)
install(FILES config/udev/70-dtsd.rules DESTINATION lib/udev/rules.d)

install(FILES config/dtsd-clinic.toml DESTINATION ${CMAKE_INSTALL_SYSCONFDIR}/dtsd RENAME dtsd.toml)
install(DIRECTORY config/rigs config/sensors config/protocols config/models config/calibrations DESTINATION ${CMAKE_INSTALL_SYSCONFDIR}/dtsd
  FILES_MATCHING PATTERN *.toml)
install(FILES config/gateway.toml DESTINATION ${CMAKE_INSTALL_SYSCONFDIR}/dts-gateway)
# Absent without npm.
install(DIRECTORY ${CMAKE_BINARY_DIR}/share/dts-gateway/web DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/dts-gateway OPTIONAL)

install(FILES config/dtsd-daq.toml clients/python/examples/board.py config/grafana/dtsd.json config/prometheus/dtsd-alerts.yml DESTINATION ${dts_doc_dir}/examples)
install(FILES config/dtsd.toml DESTINATION ${dts_doc_dir}/examples RENAME dtsd-sim.toml)
install(FILES config/protocols/README.md DESTINATION ${dts_doc_dir} RENAME protocols.md)
install(FILES README.md SECURITY.md DESTINATION ${dts_doc_dir})
install(DIRECTORY docs DESTINATION ${dts_doc_dir} FILES_MATCHING PATTERN *.md PATTERN screenshots EXCLUDE)

install(FILES clients/octave/dts_read_xdf.m DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/dts/octave)

# dts_service_page(PROGRAM): what the program says of itself, as a page of system administration: section 8.
function(dts_service_page program)
  dts_documents(${program})
  set(page ${CMAKE_BINARY_DIR}/share/man/man8/${program}.8)
  add_custom_command(OUTPUT ${page}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/share/man/man8
    COMMAND sed "1s/ 1 / 8 /;1s/User Commands/System Manager's Manual/" ${CMAKE_BINARY_DIR}/share/man/man1/${program}.1 > ${page}
    DEPENDS ${CMAKE_BINARY_DIR}/share/man/man1/${program}.1 VERBATIM)
  add_custom_target(${program}_page ALL DEPENDS ${page})
  add_dependencies(${program}_page ${program}_documents)
  install(FILES ${page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man8)
endfunction()

dts_service_page(dts-gateway)
install(FILES packaging/man/dtsd.8 packaging/man/dts-relay.8 DESTINATION ${CMAKE_INSTALL_MANDIR}/man8)
install(FILES packaging/man/dtsd.toml.5 DESTINATION ${CMAKE_INSTALL_MANDIR}/man5)
set(documented dts-gateway dtsctl)
if(TARGET dtslab)
  list(APPEND documented dtslab)
endif()
if(TARGET dts-forward)  # its libraries may be absent
  install(TARGETS dts-forward DESTINATION ${CMAKE_INSTALL_SBINDIR})
  dts_install_for_prefix(${CMAKE_SOURCE_DIR}/systemd/dts-forward.service lib/systemd/system)
  install(FILES systemd/sysusers.d/dts-forward.conf DESTINATION lib/sysusers.d)
  install(FILES systemd/tmpfiles.d/dts-forward.conf DESTINATION lib/tmpfiles.d)
  install(FILES config/forward.toml DESTINATION ${CMAKE_INSTALL_SYSCONFDIR}/dtsd)
  dts_service_page(dts-forward)
  list(APPEND documented dts-forward)
endif()
if(TARGET dts-hub)
  install(TARGETS dts-hub DESTINATION ${CMAKE_INSTALL_SBINDIR})
  install(FILES ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/dts-fleet DESTINATION ${CMAKE_INSTALL_SBINDIR})  # a link to it
  foreach(unit dts-hub.service dts-hub-users.service dts-hub-users.path)
    dts_install_for_prefix(${CMAKE_SOURCE_DIR}/systemd/${unit} lib/systemd/system)
  endforeach()
  install(FILES systemd/sysusers.d/dts-hub.conf DESTINATION lib/sysusers.d)
  install(FILES systemd/tmpfiles.d/dts-hub.conf DESTINATION lib/tmpfiles.d)
  install(FILES config/hub.toml DESTINATION ${CMAKE_INSTALL_SYSCONFDIR}/dts-hub)
  dts_service_page(dts-hub)
  dts_documents(dts-fleet)
  list(APPEND documented dts-hub dts-fleet)
endif()
if(TARGET dts-worker)
  install(TARGETS dts-worker DESTINATION ${CMAKE_INSTALL_SBINDIR})
  dts_install_for_prefix(${CMAKE_SOURCE_DIR}/systemd/dts-worker.service lib/systemd/system)
  install(FILES systemd/sysusers.d/dts-worker.conf DESTINATION lib/sysusers.d)
  install(FILES config/worker.toml DESTINATION ${CMAKE_INSTALL_SYSCONFDIR}/dtsd)
  dts_service_page(dts-worker)
  list(APPEND documented dts-worker)
endif()
if(TARGET dts-fleet-gateway)
  install(TARGETS dts-fleet-gateway DESTINATION ${CMAKE_INSTALL_BINDIR})
  dts_install_for_prefix(${CMAKE_SOURCE_DIR}/systemd/dts-fleet-gateway.service lib/systemd/system)
  install(FILES systemd/sysusers.d/dts-fleet-gateway.conf DESTINATION lib/sysusers.d)
  dts_install_for_prefix(${CMAKE_SOURCE_DIR}/systemd/tmpfiles.d/dts-fleet-gateway.conf lib/tmpfiles.d)
  install(FILES config/fleet-gateway.toml DESTINATION ${CMAKE_INSTALL_SYSCONFDIR}/dts-fleet-gateway RENAME gateway.toml)
  dts_service_page(dts-fleet-gateway)
  list(APPEND documented dts-fleet-gateway)
endif()
foreach(program ${documented})
  set(share ${CMAKE_BINARY_DIR}/share)
  if(program MATCHES "^dts(ctl|lab|-fleet)$")
    install(FILES ${share}/man/man1/${program}.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
  endif()
  install(FILES ${share}/bash-completion/completions/${program} DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/bash-completion/completions)
  install(FILES ${share}/zsh/site-functions/_${program} DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/zsh/site-functions)
endforeach()
